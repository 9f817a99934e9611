# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Duration of manoeuvres, and the order of a trial.

Warp lengths rise through a trial, so that each metre is paid out once. While warp is paid out,
the gear is slower than the ship by the speed of the warp. So the ship first speeds up, to keep the
lift of the boards.
"""

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

from trawl_ros.estimation.planning.states import DEPTHS, Manoeuvre, TowableManoeuvre
from trawl_ros.estimation.windows.operation import Block, Operation
from trawl_ros.estimation.windows.records import WindowOptions
from trawl_ros.gear.records import GearRecord
from trawl_ros.records.channels import CHANNELS

STEADY_SHARE = 0.25
"""Drift of a planned window over the largest drift of a steady window. The margin is for noise,
which makes the drift seem larger or smaller."""

STEP_MINUTES = 0.5
"""Legs are rounded up to a multiple of this, which is easy to follow on a bridge."""


@dataclass(frozen=True)
class VesselLimits:
    """Limits of ship and winches, and the range of towing speeds.

    ``winch_speed``, ``least_speed`` (m/s), ``winch_acceleration``, ``ship_acceleration`` (m/s²);
    ``least_speed`` is the lowest at which the gear keeps its steady state, ``most_speed`` the
    highest that is to be used.
    """

    winch_speed: float
    winch_acceleration: float
    ship_acceleration: float
    least_speed: float
    most_speed: float

    @property
    def veering_speed(self) -> float:
        """Speed of the ship (m/s) while veering warp."""
        return min(self.least_speed + self.winch_speed, self.most_speed)


def vessel_limits(gear: GearRecord, manoeuvres: Sequence[Manoeuvre]) -> VesselLimits:
    """Return the limits of a gear file, with the range of speeds of these manoeuvres."""
    speeds = [manoeuvre.speed for manoeuvre in manoeuvres]
    return VesselLimits(
        gear.winch.max_speed_m_s,
        gear.winch.max_acceleration_m_s2,
        gear.ship.max_acceleration_m_s2,
        min(speeds),
        max(speeds),
    )


@dataclass(frozen=True)
class Leg:
    """Leg: one manoeuvre of a trial.

    If warp is paid out, ``veering_minutes`` at ``veering_speed`` (m/s) come first. Then
    ``minutes`` pass to change, settle and take the windows.
    """

    manoeuvre: Manoeuvre
    minutes: float
    veering_speed: float = 0.0
    veering_minutes: float = 0.0

    @property
    def total_minutes(self) -> float:
        """Minutes of veering and of the manoeuvre together."""
        return self.minutes + self.veering_minutes


def winch_time(vessel: VesselLimits, metres: float) -> float:
    """Return the time (s) in which winches veer or haul a length (m), from rest to rest."""
    most, speed = vessel.winch_acceleration, vessel.winch_speed
    # Short changes end before the winch reaches its full speed.
    if metres <= speed**2 / most:
        return 2.0 * math.sqrt(metres / most)
    return metres / speed + speed / most


@dataclass(frozen=True)
class Rest:
    """Settling of a gear in a steady state.

    Tension and spread settle quickly; net and doors sink or rise together for minutes.

    Attributes
    ----------
    net_depth
        Depth of the net, m.
    decay
        Time in which the slowest motion decays to 1/e, s.
    drift
        Drift of the depth in a window below which the window counts as steady, m.
    window
        Length of a window, s.
    """

    net_depth: float
    decay: float
    drift: float
    window: float

    def left(self, change: float, moving: float, since: float = 0.0) -> float:
        """Remaining change of the net's depth, m.

        Parameters
        ----------
        change
            Whole change of the depth, m.
        moving
            Time in which ship and winches make the change, s; the gear already follows then.
        since
            Time since its end, s.
        """
        # A first-order lag with a ramp as input.
        shrunk = self.decay / moving * -math.expm1(-moving / self.decay) if moving else 1.0
        return abs(change) * shrunk * math.exp(-since / self.decay)

    def time(self, left: float) -> float:
        """Return the time (s) until a net with a remaining change ``left`` (m) is steady."""
        first = left * -math.expm1(-self.window / self.decay)
        return self.decay * math.log(max(first / self.drift, 1.0))

    def to_come(self, options: WindowOptions) -> float:
        """Return the departure (m of depth) from equilibrium that a window with this drift has."""
        return self.drift * options.slow_s / self.window


def rest_of(candidate: TowableManoeuvre, options: WindowOptions) -> Rest:
    """Return how the gear settles at a candidate, by the criterion of steady windows."""
    linear = candidate.part
    depths = {
        name: float(value)
        for name, value in zip(linear.channels, linear.values, strict=True)
        if name in DEPTHS
    }
    steady = min(
        max(options.drift_fraction * depth, CHANNELS[name].bias) for name, depth in depths.items()
    )
    return Rest(depths['net_depth'], candidate.decay, STEADY_SHARE * steady, options.window_s)


@cache
def holding_time(manoeuvre: Manoeuvre, options: WindowOptions, rest: float = 0.0) -> float:
    """Return the time (s) for which a steady state is held until all its windows are taken.

    Windows lie on a grid of blocks. A change ends within a block, which is lost.

    Parameters
    ----------
    manoeuvre
        Warp lengths and speed.
    options
        Criteria of a steady window.
    rest
        Time (s) until the gear drifts no more than a window may.
    """
    operation = Operation(options)
    inputs = (manoeuvre.port_length, manoeuvre.starboard_length, manoeuvre.speed)
    for index in range(operation.window_blocks):
        operation.add(Block(index, inputs, None, None))
    windows = options.max_windows_per_state * operation.window_blocks
    settle = max(operation.settle_blocks, math.ceil(rest / options.block_s))
    return (settle + windows + 1) * options.block_s


def arranged(manoeuvres: Sequence[Manoeuvre]) -> tuple[Manoeuvre, ...] | None:
    """Order manoeuvres by rising warp length, and at each length by falling speed.

    A state that goes on gives no further windows. So another manoeuvre of the same length comes
    between two equal ones; the result is None if there is none.
    """
    ordered: list[Manoeuvre] = []
    for length in sorted({manoeuvre.length for manoeuvre in manoeuvres}):
        left = Counter(manoeuvre for manoeuvre in manoeuvres if manoeuvre.length == length)
        while left:
            last = ordered[-1] if ordered else None
            free = [manoeuvre for manoeuvre in left if manoeuvre != last]
            if not free:
                return None
            # The most frequent one goes first; otherwise copies of it would be left at the end.
            chosen = max(
                free, key=lambda manoeuvre: (left[manoeuvre], manoeuvre.equal, manoeuvre.speed)
            )
            ordered.append(chosen)
            left -= Counter([chosen])
    return tuple(ordered)


class Timetable:
    """Timetable: durations of manoeuvres one after the other.

    Parameters
    ----------
    vessel
        Of ship and winches.
    options
        Criteria of a steady window.
    candidates
        All manoeuvres that `legs` is called with; the first one may be missing.
    """

    def __init__(
        self, vessel: VesselLimits, options: WindowOptions, candidates: Iterable[TowableManoeuvre]
    ) -> None:
        self.vessel = vessel
        self.options = options
        self._by_lengths: dict[tuple[float, float], dict[float, Rest]] = {}
        for candidate in candidates:
            done = candidate.manoeuvre
            lengths = (done.port_length, done.starboard_length)
            self._by_lengths.setdefault(lengths, {})[done.speed] = rest_of(candidate, options)
        self._legs: dict[tuple[Manoeuvre, Manoeuvre, float], Leg] = {}

    def legs(
        self, manoeuvres: Sequence[Manoeuvre], first_depth: float | None = None
    ) -> tuple[Leg, ...]:
        """Return the legs of manoeuvres in the given order.

        Parameters
        ----------
        manoeuvres
            The gear is steady in the first one at the start.
        first_depth
            Depth (m) of the net in the first, if that is not among the candidates.
        """
        if not manoeuvres:
            return ()
        first = manoeuvres[0]
        depth = self._rest(first).net_depth if first_depth is None else first_depth
        legs = [Leg(first, _rounded(holding_time(first, self.options)))]
        for before, after in pairwise(manoeuvres):
            change = (before, after, depth)
            if change not in self._legs:
                self._legs[change] = self._leg(*change)
            legs.append(self._legs[change])
            depth = self._rest(after).net_depth
        return tuple(legs)

    def _rest(self, manoeuvre: Manoeuvre) -> Rest:
        return self._at(manoeuvre)[manoeuvre.speed]

    def _leg(self, before: Manoeuvre, after: Manoeuvre, depth: float) -> Leg:
        vessel, rest = self.vessel, self._rest(after)
        moved = (
            after.port_length - before.port_length,
            after.starboard_length - before.starboard_length,
        )
        winding = winch_time(vessel, max(map(abs, moved)))
        out = max(moved) > 0.0 and after.speed < vessel.veering_speed
        speed = max(vessel.veering_speed, before.speed) if out else after.speed
        # The ship changes her speed first: the net rises or sinks, and then with the warps.
        changing = abs(speed - before.speed) / vessel.ship_acceleration
        between = self._depth_at(before, speed, depth)
        there = self._depth_at(after, speed, rest.net_depth)
        left = rest.left(between - depth, changing, max(winding - changing, 0.0))
        left += rest.left(there - between, winding)
        if not out:
            hold = holding_time(after, self.options, rest.time(left))
            return Leg(after, _rounded(max(winding, changing) + hold))
        running = _rounded(changing + winding)
        slowing = abs(speed - after.speed) / vessel.ship_acceleration
        left = rest.left(left, 0.0, slowing) + rest.left(rest.net_depth - there, slowing)
        hold = holding_time(after, self.options, rest.time(left))
        return Leg(after, _rounded(slowing + hold), speed, running)

    def _depth_at(self, manoeuvre: Manoeuvre, speed: float, known: float) -> float:
        """Depth (m) of the net at these lengths, at the nearest known speed."""
        depths = {at_speed: rest.net_depth for at_speed, rest in self._at(manoeuvre).items()}
        depths[manoeuvre.speed] = known
        return depths[min(depths, key=lambda at_speed: abs(at_speed - speed))]

    def _at(self, manoeuvre: Manoeuvre) -> Mapping[float, Rest]:
        """Settling at these lengths, by speed."""
        return self._by_lengths.get((manoeuvre.port_length, manoeuvre.starboard_length), {})


def minutes_of(legs: Sequence[Leg]) -> float:
    """Duration of a trial, min."""
    return sum(leg.total_minutes for leg in legs)


def _rounded(seconds: float) -> float:
    return STEP_MINUTES * math.ceil(seconds / 60.0 / STEP_MINUTES - 1e-9)
