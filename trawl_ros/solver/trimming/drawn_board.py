# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Random boards: coefficients drawn from the gear's prior, and rigged as a crew would.

The fastening points of one board rarely suit another: drawn moments turn it over. A crew moves the
shackles until the boards work, so a drawn board is rigged before it is tried.
"""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.stats import truncnorm

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState, TrawlError
from trawl_ros.gear.boards import FasteningRecord
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.solver.equilibrium import Equilibrium, steady_state
from trawl_ros.solver.trim import roll_for
from trawl_ros.solver.trimming.held_gear import HeldGear, attitude_at
from trawl_ros.solver.trimming.over_range import (
    CENTRE_SHIFTS_PER_CHORD,
    hole_limits,
    trim_held,
)
from trawl_ros.solver.trimming.released import ReleasedTrim, released_points

Place = tuple[float, float]
"""Warp length (m) and speed (m/s) of a steady state."""

FIRST_CENTRE_SHIFTS = CENTRE_SHIFTS_PER_CHORD[:1]
"""Shifts of the centre of pressure for the first rigging, in chords; a single one is fast."""


@dataclass(frozen=True)
class BoardDraw:
    """Options of a draw.

    Attributes
    ----------
    attack, inclination
        Angles for which a board is rigged, rad, without pitch.
    around
        Meshes around the mouth of the net with which it is rigged.
    std_factor
        Factor on the prior's std with which coefficients are drawn.
    most_draws
        Largest number of boards drawn.
    evaluations
        Largest number of evaluations of the released board, in which its angles are fitted.
    """

    attack: float = float(np.radians(20.0))
    inclination: float = float(np.radians(12.0))
    around: int = 12
    std_factor: float = 1.0
    most_draws: int = 40
    evaluations: int = 15


@dataclass(frozen=True)
class DrawnBoard:
    """Drawn and rigged board.

    Attributes
    ----------
    gear
        The gear with its coefficients and fastening points.
    model
        Model of this gear.
    steady
        Its usable steady state at each place.
    rejected
        Number of boards drawn before that cannot be towed at all places, by reason.
    """

    gear: GearRecord
    model: GearModel
    steady: dict[Place, Equilibrium]
    rejected: Counter[str]

    @property
    def coefficients(self) -> FloatArray:
        """Coefficients (q,) in the order of their law."""
        return self.model.coefficients

    @property
    def draws(self) -> int:
        """Number of boards drawn, including this one."""
        return 1 + self.rejected.total()


def draw_board(
    gear: GearRecord,
    places: Sequence[Place],
    rng: np.random.Generator,
    options: BoardDraw = BoardDraw(),
    *,
    build: Callable[[GearRecord], GearModel] = build_model,
) -> DrawnBoard:
    """Draw and rig boards until one can be towed at all places.

    Parameters
    ----------
    gear
        The gear that is towed. Its prior is normal, cut at the bounds.
    places
        Warp length (m) and speed (m/s) of each state in which the gear must be usable: stable,
        under water, and with boards within the range of their law.
    rng
        Generator of random numbers.
    options
        Options of the draw.
    build
        Function that builds the model of a gear.

    Raises
    ------
    TrawlError
        If none of the boards can be towed.
    GearError
        For a gear without boards.

    Examples
    --------
    >>> import numpy as np
    >>> import trawl_ros
    >>> from trawl_ros.solver.trimming.drawn_board import draw_board
    >>> gear = trawl_ros.load_gear('kaifuha').refined(net=0.25)
    >>> drawn = draw_board(gear, [(400.0, 2.2)], np.random.default_rng(0))
    >>> drawn.gear.board.fastening == gear.board.fastening
    False
    """
    gear.require_boards('that could be drawn')
    coarse = build(gear.changed('netting', around=min(options.around, gear.netting.around)))
    rejected: Counter[str] = Counter()
    for _ in range(options.most_draws):
        coefficients = _drawn(gear, rng, options.std_factor)
        try:
            points = _rigged(coarse.with_coefficients(coefficients), places, options)
            if points is None:
                rejected['not rigged'] += 1
                continue
            own = with_coefficients(with_fastening(gear, points), coefficients)
            model = build(own)
            steady = _steady_states(model, places)
        except NoSteadyState as refusal:
            rejected[refusal.reason] += 1
            continue
        return DrawnBoard(own, model, steady, rejected)
    reasons = ', '.join(f'{reason} {count}' for reason, count in rejected.most_common())
    raise TrawlError(
        f'{gear.name}: none of {options.most_draws} boards drawn from its `identification` can be '
        f'towed at all {len(places)} places ({reasons}); expected fewer places or a smaller std'
    )


def fastened_as(gear: GearRecord, other: GearRecord) -> GearRecord:
    """Return the gear with the fastening points of another one."""
    board = gear.board.model_copy(update={'fastening': other.board.fastening})
    return gear.model_copy(update={'board': board})


def with_fastening(gear: GearRecord, points: FloatArray) -> GearRecord:
    """Return the gear with other fastening points (3, 3) of warp, upper and lower bridle, m."""
    names = FasteningRecord.model_fields
    holes = {name: tuple(point) for name, point in zip(names, points.tolist(), strict=True)}
    fastening = FasteningRecord.model_validate(holes)
    board = gear.board.model_copy(update={'fastening': fastening})
    return gear.model_copy(update={'board': board})


def with_coefficients(gear: GearRecord, values: FloatArray) -> GearRecord:
    """Return the gear with other coefficients (q,) of its boards."""
    record = gear.board.coefficients.with_values(values)
    board = gear.board.model_copy(update={'coefficients': record})
    return gear.model_copy(update={'board': board})


def _drawn(gear: GearRecord, rng: np.random.Generator, factor: float) -> FloatArray:
    """Draw coefficients (q,) from the prior, truncated at its bounds."""
    known = gear.identification
    start, low, high = (np.array(part) for part in (known.start, known.low, known.high))
    std = factor * np.array(known.std)
    values: FloatArray = truncnorm.rvs(
        (low - start) / std, (high - start) / std, start, std, random_state=rng
    )
    return values


def _rigged(model: GearModel, places: Sequence[Place], options: BoardDraw) -> FloatArray | None:
    """Find fastening points (3, 3) for the ends of the range; None if no rigging holds the board.

    Raises
    ------
    NoSteadyState
        If the gear has no shape with boards held at the wanted angles.
    """
    ends = _ends(places)
    attitude = attitude_at(model, ends[0], options.attack, options.inclination, 0.0)
    held = trim_held(HeldGear(model, attitude, ends), model.board.points, FIRST_CENTRE_SHIFTS)
    if not held.usable:
        return None
    wanted = options.attack, roll_for(options.inclination, 0.0), 0.0
    limits = hole_limits(model.board)
    trim = ReleasedTrim(evaluations=options.evaluations)
    return released_points(model, held.points, limits, wanted, ends, trim)


def _ends(places: Sequence[Place]) -> list[Place]:
    """Return the ends of the range of warps and speeds."""
    warps, speeds = (sorted({min(part), max(part)}) for part in zip(*places, strict=True))
    return list(product(warps, speeds))


def _steady_states(model: GearModel, places: Sequence[Place]) -> dict[Place, Equilibrium]:
    """Find usable steady states at all places."""
    found: dict[Place, Equilibrium] = {}
    # The slowest first, because most boards that fall over do so there.
    for place in sorted(set(places), key=lambda place: (place[1], -place[0])):
        found[place] = steady_state(model, *place, start=_nearest(found, place)).equilibrium
    return found


def _nearest(found: dict[Place, Equilibrium], place: Place) -> Equilibrium | None:
    if not found:
        return None
    near = min(found, key=lambda other: abs(other[0] / place[0] - 1) + abs(other[1] / place[1] - 1))
    return found[near]
