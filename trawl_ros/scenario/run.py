# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Run of a trial: commands of the scenario at their times, truth at its rate.

Node and command line share it, so a scenario gives the same data in both.
"""

import math
from collections.abc import Callable
from dataclasses import replace

from trawl_ros.control.winch_controller import WinchController
from trawl_ros.core.errors import ScenarioError
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.records.truth import Truth
from trawl_ros.scenario.bridge import Bridge
from trawl_ros.scenario.scenario import Scenario
from trawl_ros.scenario.sea import build_sea
from trawl_ros.scenario.steadiness import require_steady_states
from trawl_ros.simulation.command import Command
from trawl_ros.simulation.seabed import SeabedTouched
from trawl_ros.simulation.simulation import NANOSECONDS, Simulation
from trawl_ros.solver.stepper import StepFailed

MAX_UNITS_PER_PERIOD, UNITS_PER_S = 5, 20
"""Largest period of the simulation in units of 0.05 s. The solver takes steps of two periods; with
0.5 s it stays within a per cent of a converged run."""

MIN_PERIODS_PER_WAVE = 40
"""Least number of periods of the simulation in the shortest wave. The variation of the warps'
tension is then within 3 % of a converged run."""


def periods_per_truth(truth_rate_hz: float, shortest_wave_s: float = math.inf) -> int:
    """Return the number of simulation periods between two truths.

    Parameters
    ----------
    truth_rate_hz
        Rate of the truth, Hz.
    shortest_wave_s
        Shortest period of the ship's heave, s.
    """
    units = round(UNITS_PER_S / truth_rate_hz)
    most = min(MAX_UNITS_PER_PERIOD, max(1.0, UNITS_PER_S * shortest_wave_s / MIN_PERIODS_PER_WAVE))
    longest = max(d for d in range(1, math.floor(most) + 1) if units % d == 0)
    return units // longest


class Trial:
    """Run of a scenario, from its start in equilibrium to the end of its last step.

    Parameters
    ----------
    scenario
        From `load_scenario`.
    model
        Model of the plant; by default built from the scenario.
    stamp
        Time of the start, ns.
    winches
        Makes a controller of the winches in place of that of the steps, as `Bridge` takes it.

    Attributes
    ----------
    model : GearModel
        Model of the towed plant.
    simulation : Simulation
        Simulated tow. Its command is set at each time step, from the scenario or from autopilot
        and autotrawl.
    duration_s : float
        Duration of the trial, s.

    Raises
    ------
    NoSteadyState
        If the start, or a step without a turn, has no usable steady state.
    SeabedTouched
        If the gear starts on the seabed.
    """

    def __init__(
        self,
        scenario: Scenario,
        *,
        model: GearModel | None = None,
        stamp: int = 0,
        winches: Callable[[tuple[float, float]], WinchController] | None = None,
    ) -> None:
        self.scenario = scenario
        self.model = build_model(scenario.plant) if model is None else model
        self.duration_s = scenario.duration_s
        require_steady_states(scenario, self.model)
        sea = build_sea(scenario.record.sea, self.model.water, scenario.record.seed)
        steps = periods_per_truth(scenario.record.truth_rate_hz, sea.heave.shortest_period)
        try:
            self.simulation = Simulation(
                self.model,
                scenario.start,
                heading=scenario.heading,
                stamp=stamp,
                period=1.0 / scenario.record.truth_rate_hz / steps,
                sea=sea,
                effect_set=scenario.effect_set,
            )
        except SeabedTouched as reason:
            raise SeabedTouched(f'{scenario.path}: start: {reason}') from reason
        self._first_stamp = stamp
        self._steps_per_truth = steps
        self._truths = 1 + math.floor(self.duration_s * scenario.record.truth_rate_hz + 1e-6)
        self._given = 0
        self._winches = winches
        self._bridge = Bridge(scenario, winches)
        self._wanted: tuple[float | None, float | None] = (None, None)

    @property
    def time_s(self) -> float:
        """Simulated time since the start, s."""
        return (self.simulation.now.stamp - self._first_stamp) / NANOSECONDS

    def reset(self) -> None:
        """Return to the start; the same truth is repeated."""
        self.simulation.reset()
        self._given = 0
        self._bridge = Bridge(self.scenario, self._winches)
        self._wanted = (None, None)

    def command_winches(self, port: float | None, starboard: float | None) -> None:
        """Command warp lengths (m) in place of the scenario's; None changes nothing there."""
        before = self._wanted
        self._wanted = (
            before[0] if port is None else port,
            before[1] if starboard is None else starboard,
        )

    def _command(self) -> Command:
        planned = self._bridge.command(self.time_s)
        port, starboard = self._wanted
        return replace(
            planned,
            port_length=planned.port_length if port is None else port,
            starboard_length=planned.starboard_length if starboard is None else starboard,
        )

    def step(self) -> Truth | None:
        """Advance by one period of the truth.

        Returns
        -------
        Truth or None
            The start itself at the first call; None after the end.

        Raises
        ------
        ScenarioError
            If the motion of the gear is too violent to be computed, or the gear touches the seabed.
        """
        if self._given == self._truths:
            return None
        if self._given:
            for _ in range(self._steps_per_truth):
                self.simulation.command = self._command()
                self._advance()
        self._given += 1
        truth = self.simulation.truth()
        self._bridge.observe(truth)
        return truth

    def _advance(self) -> None:
        try:
            self.simulation.advance()
        except StepFailed as reason:
            step = self.scenario.step_at(self.time_s)
            raise ScenarioError(
                f"{self.scenario.path}: step '{step.name}': the motion of the gear cannot be "
                f'computed beyond {self.time_s:.1f} s ({reason}); expected milder changes of '
                'warp length, speed or course'
            ) from reason
        except SeabedTouched as reason:
            step = self.scenario.step_at(self.time_s)
            raise SeabedTouched(
                f"{self.scenario.path}: step '{step.name}', after {self.time_s:.1f} s: {reason}"
            ) from reason
