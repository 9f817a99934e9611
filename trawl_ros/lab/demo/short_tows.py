# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Second part of the short demo: tows with a log that errs, as steady states, and their diagnosis.

Nothing is towed in time here: each state is the equilibrium of the plant, read by instruments with
errors. A gear takes 7 to 14 minutes to settle, so the same tows take a day at sea.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.progress import OnProgress
from trawl_ros.core.units import UNITS
from trawl_ros.diagnosis.procedure import diagnose_windows
from trawl_ros.diagnosis.report.result import result
from trawl_ros.diagnosis.report.writing import MODEL_FILE, write_diagnosis
from trawl_ros.estimation.windows.over_ground import GroundTrack
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.lab.trials.linearised_plant import LinearisedState, MeshResolution
from trawl_ros.lab.trials.readings import AS_STATED, steady_windows
from trawl_ros.lab.trials.tows import FULL_PLAN, PlannedTow
from trawl_ros.model.gear_model import build_model
from trawl_ros.solver.equilibrium import steady_state

SHOWN = {'door_spread': 'm', 'port_door_depth': 'm', 'net_depth': 'm', 'port_tension': 'kN'}
"""Channels of the summary with their display units."""

NO_JACOBIAN = np.empty(0)
COARSE = MeshResolution(around=12, lines=2)


@dataclass(frozen=True)
class ShortTows:
    """Tows, of which the first is from when the log was right.

    Attributes
    ----------
    gear
        Gear of the package.
    mesh
        Resolution: its netting is cut coarsely, and warps and bridles of the plant twice as fine.
    tows
        Five steady states each, on two courses.
    log_error_m_s
        What the log shows too much in all but the first tow, m/s. It is more than 6 times the
        smallest error that is detected in 80 % of such tows.
    seed
        Of the errors of the instruments.
    """

    gear: str = 'kaifuha'
    mesh: MeshResolution = COARSE
    tows: tuple[PlannedTow, ...] = FULL_PLAN.tows[:5]
    log_error_m_s: float = 0.5
    seed: int = 1

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the tows."""
        return ('baseline', *(f'tow {number}' for number in range(1, len(self.tows))))

    def windows(self) -> Iterator[SteadyWindow]:
        """Yield one steady window of each state, as instruments with errors show it."""
        model, near, tows = build_model(self.mesh.plant(self.gear)), None, []
        for number, tow in enumerate(self.tows):
            error, states = (self.log_error_m_s if number else 0.0), []
            for length, shown in tow.states:
                found = steady_state(model, length, shown - error, start=near)
                near, values = found.equilibrium, found.observables.array()
                states.append(LinearisedState((length, shown), values, NO_JACOBIAN, NO_JACOBIAN))
            tows.append(states)
        seen = steady_windows(tows, AS_STATED, np.random.default_rng(self.seed))
        places = ((tow, place) for tow in self.tows for place in range(len(tow.states)))
        for number, (window, (tow, place)) in enumerate(zip(seen, places, strict=True)):
            yield replace(
                window,
                index=number,
                state=number,
                hours=tow.moment(place).hours,
                track=GroundTrack(0.0 if tow.eastward else math.pi, 0.0, 0.0, False),
            )


@dataclass(frozen=True)
class Finding:
    """Diagnosis of tows: its ``numbers`` as in ``diagnosis.json``."""

    made: ShortTows
    numbers: dict[str, Any]

    @property
    def name(self) -> str:
        """Name of the effect."""
        return str(self.numbers['effects'][0]['name'])

    @property
    def smallest_m_s(self) -> float:
        """Smallest error of the log that is detected in 80 % of such tows, m/s."""
        return float(self.numbers['smallest_detectable']['speed_log']['bias']['size'])

    @property
    def sizes(self) -> dict[str, float]:
        """Error of the log, the smallest that is detected (m/s), and their ratio, as counted."""
        made, smallest = self.made.log_error_m_s, self.smallest_m_s
        return {'made_m_s': made, 'smallest_m_s': smallest, 'times': made / smallest}

    def errors(self, when: str) -> str:
        """List the errors of the model on the states held out, ``before`` or ``after``."""
        channels = self.numbers['channels']
        return ', '.join(
            f'{name.replace("_", " ").removeprefix("port ")} '
            f'{channels[name][when] / UNITS[unit].size:.1f} {unit}'
            for name, unit in SHOWN.items()
            if name in channels
        )


def diagnose_short_tows(folder: Path, on_progress: OnProgress) -> Finding:
    """Make the tows, diagnose them, and write report, pictures and repaired gear to ``folder``.

    Raises
    ------
    TrawlError
        If nothing is named.
    """
    short = ShortTows()
    windows, known = tuple(short.windows()), frozenset({0})
    gear = short.mesh.model(short.gear)
    found = diagnose_windows(gear, windows, short.names, known, on_progress)
    write_diagnosis(found, (), folder)
    if not (folder / MODEL_FILE).is_file():
        raise TrawlError(f'{folder}: found {found.verdict}, expected the log to be named')
    return Finding(short, result(found, ()))
