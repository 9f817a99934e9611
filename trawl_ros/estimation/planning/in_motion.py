# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What a fit of the whole tow will know after a plan: its commands are towed, without data."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import ScenarioError, TrawlError
from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
from trawl_ros.core.schema import validated
from trawl_ros.estimation.bag_motion import STRETCHES, towed_gear
from trawl_ros.estimation.fit.laws import LawQuantities
from trawl_ros.estimation.motion.expected import expected_rows
from trawl_ros.estimation.motion.fit_records import MotionOptions
from trawl_ros.estimation.motion.series import Series, TowReadings
from trawl_ros.estimation.motion.stretches import GRID_S, moving_tow
from trawl_ros.estimation.motion.towing.linearised_tow import LinearisedTow
from trawl_ros.estimation.motion.towing.records import LeftOut, MovingTow
from trawl_ros.estimation.planning.scenario import scenario_of
from trawl_ros.estimation.planning.search import DesignProblem
from trawl_ros.estimation.planning.states import PLANNED
from trawl_ros.estimation.planning.sweep import SweepTrial
from trawl_ros.gear.records import GearRecord
from trawl_ros.instruments.parameters import load_instruments
from trawl_ros.records.channels import CHANNELS, INPUTS
from trawl_ros.scenario.records import ScenarioRecord
from trawl_ros.scenario.scenario import Scenario
from trawl_ros.simulation.ship import Ship, Winch


@dataclass(frozen=True)
class KnownInMotion:
    """Quantities known after a fit of the towed plan.

    Attributes
    ----------
    steady, whole
        By its steady parts alone, and with hauling, veering and changes of speed.
    left_out
        Stretches along which the model cannot be towed, so that they do not count.
    """

    steady: LawQuantities
    whole: LawQuantities
    left_out: tuple[LeftOut, ...] = ()

    @property
    def left_out_minutes(self) -> float:
        """Time of the stretches that are left out, min."""
        return sum(part.end - part.begin for part in self.left_out) / 60.0

    @property
    def ratio(self) -> float:
        """Std by the whole tow over that by its steady parts, geometric mean over quantities."""
        return float(np.exp(np.mean(np.log(self.whole.sd / self.steady.sd))))


def known_in_motion(
    gear: GearRecord, trial: SweepTrial, problem: DesignProblem, on_progress: OnProgress = ignore
) -> KnownInMotion:
    """Tow the model along the commands of a plan, and compute what a fit of this tow will know.

    Parameters
    ----------
    gear
        From `load_gear`.
    trial
        The plan.
    problem
        The problem it solves; the boards are towed with its coefficients.
    on_progress
        Called after each stretch.

    Raises
    ------
    TrawlError
        If the model cannot be towed along any of it, or the trial is too long for the fit.
    """
    path = Path('trial.yaml')
    record = validated(ScenarioRecord, scenario_of(trial, gear.name), path, ScenarioError)
    scenario = Scenario(path, record, gear, gear, load_instruments())
    tow = moving_tow(planned_readings(scenario), 'the trial', STRETCHES)
    whole, linear = _known(gear, tow, problem, on_progress)
    if not linear.towed.any():
        raise TrawlError(linear.left_out[0].why)
    steady, _ = _known(gear, tow.only_steady(), problem, ignore)
    return KnownInMotion(steady, whole, linear.left_out)


def planned_readings(scenario: Scenario) -> TowReadings:
    """Readings that instruments will give along a scenario, without errors.

    Their periods and noise are those of the channel table. What is measured reads 1 until the model
    has been towed.
    """
    gear, start, times = scenario.gear, scenario.start, _times(scenario, 1.0 / GRID_S)
    ship = Ship(np.zeros(3), scenario.heading, start.speed, 0.0)
    port, starboard = Winch(start.port_length, 0.0), Winch(start.starboard_length, 0.0)
    rows = []
    for time in times:
        rows.append(
            (port.length, starboard.length, ship.speed, ship.heading, port.speed, starboard.speed)
        )
        command = scenario.commands_at(time)
        ship = ship.advanced(gear.ship, command.speed, command.turn_rate, np.zeros(3), GRID_S)
        port = port.advanced(gear.winch, command.port_length, GRID_S)
        starboard = starboard.advanced(gear.winch, command.starboard_length, GRID_S)
    *inputs, port_speeds, starboard_speeds = np.array(rows).T
    series = {
        name: Series(times, values, CHANNELS[name].noise)
        for name, values in zip((*INPUTS, 'heading'), inputs, strict=True)
    }
    for name in PLANNED:
        own = _times(scenario, CHANNELS[name].min_rate)
        series[name] = Series(own, np.ones(len(own)), CHANNELS[name].noise)
    return TowReadings(0, series, (Series(times, port_speeds), Series(times, starboard_speeds)))


def _times(scenario: Scenario, rate: float) -> FloatArray:
    """Times (n,) of readings at a rate (Hz), s."""
    return np.arange(1 + int(scenario.duration_s * rate)) / rate


def _known(
    gear: GearRecord, tow: MovingTow, problem: DesignProblem, on_progress: OnProgress
) -> tuple[LawQuantities, LinearisedTow]:
    """Quantities known after a fit of a tow, and the tow as it is linearised."""
    total = len(tow) * tow.stretch_s

    def show(stretch: int) -> None:
        done = (stretch + 1) * tow.stretch_s
        on_progress(WorkProgress('towing along the plan', done, total, 's'))

    towed, prior, options = towed_gear(gear, net=False), problem.prior, MotionOptions()
    (linear,), data = expected_rows(
        towed, [tow], prior, problem.coefficients, options, on_stretch=show
    )
    covariance = data.joined(options.sizes).covariance[: len(prior), : len(prior)]
    return problem.quantities(covariance * np.outer(prior.std, prior.std)), linear
