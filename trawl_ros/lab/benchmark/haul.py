# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Hauling manoeuvre at several step sizes, with an identical motion of ship and winches."""

import math
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.observables import observe
from trawl_ros.model.state import Tow
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.simulation.command import Command
from trawl_ros.simulation.ship import Ship, Winch
from trawl_ros.simulation.simulation import tow_of
from trawl_ros.solver.equilibrium import Equilibrium, find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint
from trawl_ros.solver.stepper import (
    STEPPER_OPTIONS,
    Motion,
    StepFailed,
    Stepper,
    StepperOptions,
    at_rest,
)

FROM, TO = Command(500.0, 500.0, 2.1), Command(400.0, 400.0, 1.9)
"""100 m are hauled as fast as the winches can, while the ship slows down."""

START = OperatingPoint(FROM.port_length, FROM.starboard_length, FROM.speed)

FINEST_S = 0.025
"""Step of ship and winches in every run, and the shortest step of the gear."""

CONVERGED_S = 0.05
"""Step of the run with which the others are compared."""

LOOK_EVERY_S = 2.0
"""Shortest interval between two samples of the observables; other steps sample later."""

WATCHED = (
    'door_spread', 'port_door_depth', 'starboard_door_depth', 'port_tension',
    'starboard_tension', 'net_depth', 'vertical_opening', 'port_attack', 'starboard_attack',
    'port_inclination', 'starboard_inclination',
)  # fmt: skip


@dataclass(frozen=True)
class Ride:
    """Observables seen during one run of the manoeuvre.

    ``seen`` (n, n_watched) holds the observables of `WATCHED`, one row every ``every_s`` seconds.
    ``factorisations`` counts those of the stepper's matrix.
    """

    seen: FloatArray
    every_s: float
    factorisations: int

    def at_steps_of(self, other: 'Ride') -> FloatArray:
        """Observables (n, n_watched) at the samples of another run with longer steps."""
        stride = round(other.every_s / self.every_s)
        return self.seen[stride - 1 :: stride][: len(other.seen)]


@dataclass(frozen=True)
class HaulManoeuvre:
    """Hauling manoeuvre of one gear.

    ``start`` is its motion at the start, and ``tows`` its towing boundary every `FINEST_S` seconds.
    """

    model: GearModel
    start: Motion
    tows: tuple[Tow, ...]

    @property
    def duration_s(self) -> float:
        """Duration of the manoeuvre, s."""
        return FINEST_S * (len(self.tows) - 1)

    def run(
        self,
        step_s: float,
        look_every_s: float = LOOK_EVERY_S,
        options: StepperOptions = STEPPER_OPTIONS,
    ) -> 'Ride':
        """Run the manoeuvre with one step size.

        A step that does not converge is taken in two halves, as in `Simulation`.

        Raises
        ------
        StepFailed
            If not even the shortest steps converge.
        """
        stride = round(step_s / FINEST_S)
        looks = math.ceil(look_every_s / step_s - 1e-9)
        columns = [OBSERVABLES.index(name) for name in WATCHED]
        stepper, motion = Stepper(self.model, options), self.start
        seen = []
        for number, at in enumerate(range(stride, len(self.tows), stride), 1):
            motion = self._advanced(stepper, motion, at, stride)
            if number % looks == 0:
                seen.append(observe(self.model, motion.state, self.tows[at]).array()[columns])
        return Ride(np.array(seen), looks * step_s, stepper.factorisations)

    def _advanced(self, stepper: Stepper, motion: Motion, at: int, stride: int) -> Motion:
        try:
            return stepper.step(motion, self.tows[at], stride * FINEST_S)
        except StepFailed:
            if stride == 1:
                raise
            half = stride // 2
            between = self._advanced(stepper, motion, at - half, stride - half)
            return self._advanced(stepper, between, at, half)


def haul_of(model: GearModel, duration_s: float, start: Equilibrium | None = None) -> HaulManoeuvre:
    """Return the manoeuvre from the steady state at `FROM`, which may be given."""
    if start is None:
        start = find_equilibrium(model, START)
    tows = _tows(model, model.gear, round(duration_s / FINEST_S))
    return HaulManoeuvre(model, at_rest(start.state), tows)


def _tows(model: GearModel, gear: GearRecord, steps: int) -> tuple[Tow, ...]:
    ship = Ship(np.zeros(3), 0.0, FROM.speed, 0.0)
    winches = (Winch(FROM.port_length, 0.0), Winch(FROM.starboard_length, 0.0))
    tows = [tow_of(model, ship, winches)]
    current = model.water.surface_current
    for _ in range(steps):
        ship = ship.advanced(gear.ship, TO.speed, TO.turn_rate, current, FINEST_S)
        winches = (
            winches[0].advanced(gear.winch, TO.port_length, FINEST_S),
            winches[1].advanced(gear.winch, TO.starboard_length, FINEST_S),
        )
        tows.append(tow_of(model, ship, winches))
    return tuple(tows)


@dataclass(frozen=True)
class Error:
    """Largest difference of any watched observable between a run and the converged run.

    ``of_range`` is a share of the range of the observable during the manoeuvre, ``of_value`` a
    share of its mean magnitude. ``worst`` names the observable with the largest share of its range.
    """

    of_range: float
    of_value: float
    worst: str


def error(ride: Ride, converged: Ride) -> Error:
    """Error of a run against the converged run, over all samples."""
    difference = np.abs(ride.seen - converged.at_steps_of(ride)).max(axis=0)
    by_range = difference / np.ptp(converged.seen, axis=0)
    by_value = difference / np.abs(converged.seen).mean(axis=0)
    return Error(float(by_range.max()), float(by_value.max()), WATCHED[int(by_range.argmax())])
