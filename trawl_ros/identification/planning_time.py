"""How long manoeuvres take, and in which order they are done.

Warp lengths rise through a trial, so that each metre is paid out once. While warp runs out, the
gear goes through the water that much slower than the ship; so she first goes faster, lest the
boards lose their lift.
"""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

from trawl_ros.gear.records import GearRecord
from trawl_ros.identification.operation import Block, Operation
from trawl_ros.identification.planning_states import Manoeuvre
from trawl_ros.identification.window_records import WindowOptions

STEP_MINUTES = 0.5
"""To this a leg is rounded up: what one can say to a bridge."""


@dataclass(frozen=True)
class Ability:
    """What ship and winches can do, and how fast the gear must be towed.

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
        """Speed of the ship (m/s) while warp runs out."""
        return min(self.least_speed + self.winch_speed, self.most_speed)


def ability_of(gear: GearRecord, manoeuvres: Sequence[Manoeuvre]) -> Ability:
    """What a gear file says of ship and winches, between the speeds of these manoeuvres."""
    speeds = [one.speed for one in manoeuvres]
    return Ability(
        gear.winch.max_speed_m_s,
        gear.winch.max_acceleration_m_s2,
        gear.ship.max_acceleration_m_s2,
        min(speeds),
        max(speeds),
    )


@dataclass(frozen=True)
class Leg:
    """One manoeuvre of a trial.

    ``veering_minutes`` at ``veering_speed`` come first where warp runs out from a slower tow;
    then ``minutes`` to change, settle and take the windows.
    """

    manoeuvre: Manoeuvre
    minutes: float
    veering_speed: float = 0.0
    veering_minutes: float = 0.0

    @property
    def total_minutes(self) -> float:
        """Both together."""
        return self.minutes + self.veering_minutes


def winch_time(ability: Ability, metres: float) -> float:
    """Time (s) to pay out or haul so many metres, from rest to rest."""
    most, speed = ability.winch_acceleration, ability.winch_speed
    if metres <= speed**2 / most:
        return 2.0 * math.sqrt(metres / most)
    return metres / speed + speed / most


@cache
def holding_time(manoeuvre: Manoeuvre, options: WindowOptions) -> float:
    """Time (s) for which a steady state is held until all its windows are taken.

    Windows lie on a grid of blocks: one block more, since the change ends within one.
    """
    operation = Operation(options)
    inputs = (manoeuvre.port_length, manoeuvre.starboard_length, manoeuvre.speed)
    for index in range(operation.window_blocks):
        operation.add(Block(index, inputs, None, None))
    windows = options.max_windows_per_state * operation.window_blocks
    return (operation.settle_blocks + windows + 1) * options.block_s


def arranged(manoeuvres: Sequence[Manoeuvre]) -> tuple[Manoeuvre, ...] | None:
    """Put manoeuvres in order: warp lengths rising, at each length speeds falling.

    What is done twice comes again after another manoeuvre of that length, for a state that goes
    on gives no more windows. None where nothing can come in between.
    """
    ordered: list[Manoeuvre] = []
    for length in sorted({one.length for one in manoeuvres}):
        left = Counter(one for one in manoeuvres if one.length == length)
        while left:
            last = ordered[-1] if ordered else None
            free = [one for one in left if one != last]
            if not free:
                return None
            # The one that is left most often first: else it would meet itself at the end.
            chosen = max(free, key=lambda one: (left[one], one.equal, one.speed))
            ordered.append(chosen)
            left -= Counter([chosen])
    return tuple(ordered)


def legs_of(
    manoeuvres: Sequence[Manoeuvre], ability: Ability, options: WindowOptions
) -> tuple[Leg, ...]:
    """Give the legs of manoeuvres in the order in which they stand; the trial starts in the
    first.
    """
    if not manoeuvres:
        return ()
    legs = [Leg(manoeuvres[0], _rounded(holding_time(manoeuvres[0], options)))]
    for before, after in pairwise(manoeuvres):
        legs.append(_leg(before, after, ability, options))
    return tuple(legs)


def _leg(before: Manoeuvre, after: Manoeuvre, ability: Ability, options: WindowOptions) -> Leg:
    out = max(
        after.port_length - before.port_length, after.starboard_length - before.starboard_length
    )
    change = max(
        abs(after.port_length - before.port_length),
        abs(after.starboard_length - before.starboard_length),
    )
    moving = winch_time(ability, change)
    hold = holding_time(after, options)
    speed = ability.veering_speed
    if out <= 0.0 or after.speed >= speed:
        slowing = abs(after.speed - before.speed) / ability.ship_acceleration
        return Leg(after, _rounded(max(moving, slowing) + hold))
    running = _rounded(moving + max(speed - before.speed, 0.0) / ability.ship_acceleration)
    slowing = (max(speed, before.speed) - after.speed) / ability.ship_acceleration
    return Leg(after, _rounded(slowing + hold), max(speed, before.speed), running)


def minutes_of(legs: Sequence[Leg]) -> float:
    """How long a trial takes, min."""
    return sum(leg.total_minutes for leg in legs)


def _rounded(seconds: float) -> float:
    return STEP_MINUTES * math.ceil(seconds / 60.0 / STEP_MINUTES - 1e-9)
