# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Simulation of a tow in time: ship, winches and gear, from an equilibrium onward."""

from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.errors import ScenarioError
from trawl_ros.effects.base.effect import Situation, sense
from trawl_ros.effects.effect_set import NO_EFFECTS, EffectSet
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.numerics import cross
from trawl_ros.model.state import Tow, halfway
from trawl_ros.records.truth import GearPicture, Truth
from trawl_ros.simulation.command import Command
from trawl_ros.simulation.reading import read_picture, read_truth
from trawl_ros.simulation.sea import Sea
from trawl_ros.simulation.seabed import require_clear
from trawl_ros.simulation.ship import Ship, Winch
from trawl_ros.solver.equilibrium import find_usable
from trawl_ros.solver.operating_point import OperatingPoint, block_offsets
from trawl_ros.solver.stepper import HALVINGS, Motion, StepFailed, Stepper, at_rest

NANOSECONDS = 1_000_000_000
CALM = Sea()
COUNTER_ITERATIONS = 4
"""Fixed-point iterations for the counters; errors of 5 % are below a millimetre after these."""


@dataclass(frozen=True)
class Instant:
    """State of ship, winches and gear at one time (ns)."""

    stamp: int
    ship: Ship
    winches: tuple[Winch, Winch]
    motion: Motion


def tow_of(model: GearModel, ship: Ship, winches: tuple[Winch, Winch]) -> Tow:
    """Return the towing boundary that ship and winches impose on the gear at one instant."""
    offsets = block_offsets(model, ship.heading)
    velocity = ship.velocity + model.water.surface_current
    spin = np.array([0.0, 0.0, ship.yaw_rate])
    return Tow(
        blocks=ship.position + offsets,
        block_velocities=velocity + cross(spin, offsets),
        lengths=np.array([winch.length for winch in winches]),
        length_rates=np.array([winch.speed for winch in winches]),
    )


class Simulation:
    """Simulation of a gear under tow, from equilibrium at the first command.

    Parameters
    ----------
    model
        Model from `build_model`.
    command
        Operating point of the start.
    heading
        First heading, ENU yaw, rad.
    stamp
        Time of the start, ns.
    period
        Time between two instants, s. The solver takes steps of twice the period; the instant in
        between is interpolated by the cubic through both ends.
    sea
        Heave, seabed and schools of fish.
    effect_set
        Effects beyond the model. Commands to winches and ship are in terms of counters and log.

    Raises
    ------
    NoSteadyState
        If there is no steady state at the first command.
    ScenarioError
        If the tow would start in a turn, or on the seabed (`SeabedTouched`).

    Examples
    --------
    >>> import trawl_ros
    >>> model = trawl_ros.build_model(trawl_ros.load_gear('kaifuha').refined(net=0.25))
    >>> simulation = trawl_ros.Simulation(model, trawl_ros.Command(500.0, 500.0, 2.1))
    >>> simulation.command = trawl_ros.Command(500.0, 500.0, 2.3)
    >>> for _ in range(100):
    ...     now = simulation.advance()
    >>> now.stamp, bool(now.ship.speed > 2.1)
    (10000000000, True)
    >>> round(simulation.truth().winches[0].length)
    500
    """

    def __init__(
        self,
        model: GearModel,
        command: Command,
        *,
        heading: float = 0.0,
        stamp: int = 0,
        period: float = 0.1,
        sea: Sea = CALM,
        effect_set: EffectSet = NO_EFFECTS,
    ) -> None:
        if command.turn_rate:
            raise ScenarioError(
                f'command: found a rate of turn of {command.turn_rate} rad/s at the start of the '
                'tow, expected 0: a tow starts on a straight course'
            )
        self._plain, self._effect_set = model, effect_set
        self.sea = sea
        self.command = command
        self._period = round(period * NANOSECONDS)
        self._reached: Instant | None = None
        self._first_stamp = stamp
        self.model = self._gear_at(stamp, command, heading)
        self._stepper = Stepper(self.model)
        self.now = self._first(command, heading, stamp)
        self._start = (command, self.now)
        require_clear(sea.seabed, model, self.now.motion.state)

    def _first(self, command: Command, heading: float, stamp: int) -> Instant:
        towed = self._towed(command)
        point = OperatingPoint(towed.port_length, towed.starboard_length, towed.speed, heading)
        equilibrium = find_usable(self.model, point).equilibrium
        return Instant(
            stamp=stamp,
            ship=Ship(np.zeros(3), heading, towed.speed, 0.0),
            winches=(Winch(towed.port_length, 0.0), Winch(towed.starboard_length, 0.0)),
            motion=at_rest(equilibrium.state),
        )

    def reset(self) -> None:
        """Return to the start; the same commands then give bitwise the same tow."""
        self.command, self.now = self._start
        self.model = self._gear_at(self.now.stamp, self.command, self.now.ship.heading)
        self._stepper = Stepper(self.model)
        self._reached = None

    def advance(self) -> Instant:
        """Advance by one period; a command takes effect with the next step of the solver.

        Raises
        ------
        StepFailed
            If the motion cannot be computed even with short steps.
        SeabedTouched
            If the gear touches the seabed; the state does not change then.
        """
        if self._reached is None:
            start = self.now
            reached = self._advanced(start, 2 * self._period, HALVINGS)
            require_clear(self.sea.seabed, self.model, reached.motion.state)
            self.now = self._between(start, reached)
            self._reached = reached
        else:
            self.now, self._reached = self._reached, None
        return self.now

    def _between(self, start: Instant, end: Instant) -> Instant:
        span = self._period / NANOSECONDS
        ship, winches = self._boundary(start, span)
        # The blocks must lie on the same cubic as the gear: an error of a millimetre between block
        # and wire is a kilonewton of tension.
        z0, z1 = start.ship.position[2], end.ship.position[2]
        v0, v1 = start.ship.heave_rate, end.ship.heave_rate
        return Instant(
            start.stamp + self._period,
            ship.heaved(
                0.5 * (z0 + z1) + span / 4 * (v0 - v1),
                0.75 / span * (z1 - z0) - 0.25 * (v0 + v1),
            ),
            winches,
            at_rest(halfway(start.motion.state, end.motion.state, 2 * span)),
        )

    def _boundary(self, now: Instant, dt: float) -> tuple[Ship, tuple[Winch, Winch]]:
        """Return ship and winches after ``dt`` s under the present command."""
        gear, wanted = self.model.gear, self._towed(self.command)
        surface = self.model.water.surface_current
        ship = now.ship.advanced(gear.ship, wanted.speed, wanted.turn_rate, surface, dt)
        ship = ship.heaved(*self.sea.heave.at(self._seconds(now.stamp) + dt))
        (port, starboard), speeds = now.winches, wanted.winch_speeds
        return ship, (
            port.advanced(gear.winch, wanted.port_length, dt, speeds[0]),
            starboard.advanced(gear.winch, wanted.starboard_length, dt, speeds[1]),
        )

    def _advanced(self, now: Instant, span: int, halvings: int) -> Instant:
        dt = span / NANOSECONDS
        ship, winches = self._boundary(now, dt)
        if self._effect_set:
            self.model = self._gear_at(now.stamp + span, self.command, ship.heading)
            self._stepper.model = self.model
        try:
            motion = self._stepper.step(now.motion, tow_of(self.model, ship, winches), dt)
        except StepFailed:
            if halvings == 0:
                raise
            half = self._advanced(now, span // 2, halvings - 1)
            return self._advanced(half, span - span // 2, halvings - 1)
        return Instant(now.stamp + span, ship, winches, motion)

    def stop_lengths(self) -> tuple[float, float]:
        """Return the warp lengths (m, by the counters) where winches stop soonest, port first."""
        limits = self.model.gear.winch
        stops = np.array([winch.stop_length(limits) for winch in self.now.winches])
        shown = stops
        for _ in range(COUNTER_ITERATIONS):
            port, starboard = map(float, shown)
            towed = self._towed(replace(self.command, port_length=port, starboard_length=starboard))
            shown = shown + stops - (towed.port_length, towed.starboard_length)
        # A stopped winch must not creep.
        stands = [winch.speed == 0.0 for winch in self.now.winches]
        commanded = (self.command.port_length, self.command.starboard_length)
        port, starboard = np.where(stands, commanded, shown)
        return float(port), float(starboard)

    def _towed(self, command: Command) -> Command:
        """Return the true command for which counters and log show the given one."""
        if not self._effect_set:
            return command
        shown = (command.port_length, command.starboard_length, command.speed)
        port, starboard, speed = map(
            float, self._effect_set.apply_to_inputs(np.array(shown), Situation(shown))
        )
        return replace(command, port_length=port, starboard_length=starboard, speed=speed)

    def _gear_at(self, stamp: int, command: Command, heading: float) -> GearModel:
        """Return the gear model with the effects in the situation at ``stamp``."""
        shown = (command.port_length, command.starboard_length, command.speed)
        hours = self._seconds(stamp) / 3600.0
        return self._effect_set.gear(self._plain, Situation(shown, heading, sense(heading), hours))

    def _seconds(self, stamp: int) -> float:
        """Return the time since the start, s."""
        return (stamp - self._first_stamp) / NANOSECONDS

    def truth(self) -> Truth:
        """Return the truth at the present instant, for the instruments."""
        now = self.now
        truth = read_truth(
            self.model,
            now.stamp,
            now.ship,
            now.winches,
            now.motion.state,
            tow_of(self.model, now.ship, now.winches),
        )
        return replace(
            truth,
            schools=self.sea.schools_at(self._seconds(now.stamp)),
            seabed=self.sea.seabed_under(now.ship.position, truth.net.sonar_position),
        )

    def picture(self) -> GearPicture:
        """Return a picture of the present instant, for drawing."""
        now = self.now
        picture = read_picture(
            self.model, now.stamp, now.motion.state, tow_of(self.model, now.ship, now.winches)
        )
        return replace(picture, schools=self.sea.schools_at(self._seconds(now.stamp)))
