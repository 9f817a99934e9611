# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Tow that obeys commands as they come; `Trial` follows those of a scenario."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Protocol

from trawl_ros.core.errors import NoSteadyState, ScenarioError
from trawl_ros.effects.effect_set import NO_EFFECTS, EffectSet, effects_of
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.model.observables import fallen_boards
from trawl_ros.records.truth import SIDES, Truth
from trawl_ros.scenario.records import MAX_TRUTH_HZ
from trawl_ros.simulation.command import Command
from trawl_ros.simulation.simulation import NANOSECONDS, Simulation
from trawl_ros.solver.stepper import StepFailed

DEFAULT_START = (500.0, 2.0)
"""Warp length (m) and speed (m/s)."""

OTHER_STARTS = ((500.0, 2.2), (400.0, 2.3), (300.0, 2.3))
"""Tried in this order where the gear cannot be towed at the default."""


def fallen_sides(simulation: Simulation) -> str:
    """Return the sides whose boards have fallen, in words; '' for none and for a pair trawl."""
    if simulation.model.paired:
        return ''
    fallen = fallen_boards(simulation.now.motion.state)
    return ' and '.join(side for side, lies in zip(SIDES, fallen, strict=True) if lies)


class TowSetup(Protocol):
    """Tow that `sim_node` advances."""

    simulation: Simulation

    @property
    def time_s(self) -> float:
        """Simulated time since the start, s."""

    def step(self) -> Truth | None:
        """Advance by one period of the truth; the start itself at first, None after the end."""

    def command_winches(self, port: float | None, starboard: float | None) -> None:
        """Command warp lengths (m); None leaves that winch as it is."""

    def reset(self) -> None:
        """Return to the start."""


class CommandedTow:
    """Tow without end, towards whatever was commanded last.

    Parameters
    ----------
    model
        The plant.
    start
        The steady tow it starts from.
    heading
        First heading, ENU yaw, rad.
    truth_rate_hz
        Rate of truth, Hz: `MAX_TRUTH_HZ` divided by a whole number.
    effect_set
        Effects that the plant has beyond the model.

    Raises
    ------
    ScenarioError
        If the rate is another.
    NoSteadyState
        If the start is none.
    """

    def __init__(
        self,
        model: GearModel,
        start: Command,
        *,
        heading: float,
        truth_rate_hz: float,
        effect_set: EffectSet = NO_EFFECTS,
    ) -> None:
        every = MAX_TRUTH_HZ / truth_rate_hz
        if abs(every - round(every)) > 1e-9 * every:
            raise ScenarioError(
                f'parameter truth_rate_hz: found {truth_rate_hz:g}, expected {MAX_TRUTH_HZ:g} '
                'divided by a whole number (Hz)'
            )
        self.simulation = Simulation(
            model, start, heading=heading, period=1.0 / MAX_TRUTH_HZ, effect_set=effect_set
        )
        self._steps = round(every)
        self._started = False

    @property
    def time_s(self) -> float:
        """Simulated time since the start, s."""
        return self.simulation.now.stamp / NANOSECONDS

    def command_winches(
        self,
        port: float | None,
        starboard: float | None,
        speeds: tuple[float, float] = (math.inf, math.inf),
    ) -> None:
        """Command warp lengths (m), None leaving that winch as it is, and greatest speeds (m/s)."""
        wanted = self.simulation.command
        self.simulation.command = replace(
            wanted,
            winch_speeds=speeds,
            port_length=wanted.port_length if port is None else port,
            starboard_length=wanted.starboard_length if starboard is None else starboard,
        )

    def command_vessel(self, speed: float, turn_rate: float) -> None:
        """Command a speed through the water (m/s) and a rate of turn (rad/s, to port)."""
        self.simulation.command = replace(self.simulation.command, speed=speed, turn_rate=turn_rate)

    def stop_turning(self) -> None:
        """Steer straight on at the last commanded speed."""
        # The speed is kept: a ship that stops drops her gear on the seabed.
        self.simulation.command = replace(self.simulation.command, turn_rate=0.0)

    def reset(self) -> None:
        """Return to the start."""
        self.simulation.reset()
        self._started = False

    def step(self) -> Truth:
        """Advance by one period of the truth; the start itself at first.

        Raises
        ------
        ScenarioError
            If the gear is moved so violently that its motion cannot be computed.
        """
        if self._started:
            for _ in range(self._steps):
                try:
                    self.simulation.advance()
                except StepFailed as reason:
                    raise ScenarioError(
                        f'the motion of the gear cannot be computed beyond {self.time_s:.1f} s '
                        f'({reason}); expected milder commands'
                    ) from reason
        self._started = True
        return self.simulation.truth()


def commanded_tow(
    gear: GearRecord,
    start: tuple[float, float],
    *,
    heading: float,
    truth_rate_hz: float,
    warn: Callable[[str], object],
) -> CommandedTow:
    """Build a tow from where it is asked for or, at the default, from where this gear has one.

    A gear that was refitted or repaired need not have a steady state at the default start.

    Parameters
    ----------
    gear
        The plant, with its effects.
    start
        Warp length (m) and speed (m/s).
    heading, truth_rate_hz
        As in `CommandedTow`.
    warn
        Takes a sentence where the tow starts elsewhere.

    Raises
    ------
    NoSteadyState
        If there is none at the start, nor at those tried instead of the default.
    """
    model, effects = build_model(gear), effects_of(gear)
    refusals: list[str] = []
    remedy = ''
    for length, speed in (start, *OTHER_STARTS) if start == DEFAULT_START else (start,):
        command = Command(length, length, speed)
        try:
            tow = CommandedTow(
                model, command, heading=heading, truth_rate_hz=truth_rate_hz, effect_set=effects
            )
        except NoSteadyState as reason:
            refusals.append(str(reason))
            remedy = remedy or reason.remedy
            continue
        if refusals:
            warn(f'{"; ".join(refusals)}; starts at {length:g} m and {speed:g} m/s')
        return tow
    raise NoSteadyState('; '.join(refusals), remedy=remedy)
