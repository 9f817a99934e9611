"""Plants of the trials, the models fitted to them, and random boards."""

from collections import Counter
from dataclasses import dataclass
from itertools import chain

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState, TrawlError
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import build_model
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.equilibrium import Equilibrium, find_equilibrium, require_usable
from trawl_ros.solver.operating_point import OperatingPoint
from trawl_ros.solver.sensitivity import sensitivities

MOST_DRAWS = 200
"""Boards drawn for one trial at most."""

State = tuple[float, float]
"""Warp length (m) and speed (m/s) of a steady state."""

TOWS: tuple[tuple[State, ...], ...] = (
    ((300.0, 2.4), (400.0, 2.2), (550.0, 2.0), (700.0, 2.4), (900.0, 2.2)),
    ((300.0, 2.2), (400.0, 2.0), (550.0, 2.4), (700.0, 2.2), (900.0, 2.0)),
    ((300.0, 2.0), (400.0, 2.4), (550.0, 2.2), (700.0, 2.0), (900.0, 2.4)),
    ((300.0, 2.4), (400.0, 2.2), (550.0, 2.0), (700.0, 2.4), (900.0, 2.2)),
)
"""Steady states of a trial, tow by tow."""

HELD_OUT: tuple[State, ...] = ((350.0, 2.3), (480.0, 2.1), (620.0, 2.3), (800.0, 2.1))
"""The tow that is predicted and not fitted."""


@dataclass(frozen=True)
class Cut:
    """Mesh of a gear's net, and refinement of the plant.

    ``around`` counts the meshes around the mouth of the model; the plant has ``lines`` times its
    segments of warps and bridles and ``net`` times its meshes, and joins none where ``unjoined``.
    """

    around: int
    lines: int = 1
    net: float = 1.0
    unjoined: bool = False

    def model(self, gear: str) -> GearRecord:
        """Gear that is fitted."""
        record = load_gear(gear)
        netting = record.netting.model_copy(update={'around': self.around})
        return record.model_copy(update={'netting': netting})

    def plant(self, gear: str) -> GearRecord:
        """Gear that makes the data."""
        return self.model(gear).refined(
            warp=self.lines, bridle=self.lines, net=self.net, unjoined=self.unjoined
        )

    def __str__(self) -> str:
        parts = [f'{self.lines} times the segments of warps and bridles'] if self.lines > 1 else []
        if self.net > 1.0:
            parts.append(f'{self.net:g} times the meshes around the mouth')
        if self.unjoined:
            parts.append('no meshes joined toward the end of the net')
        return ', '.join(parts) or 'as the model'


@dataclass(frozen=True)
class Look:
    """Steady state of the plant: observables (22,) and their sensitivities (22, 3) to both
    warp lengths and speed, and (22, 12) to the coefficients.
    """

    state: State
    values: FloatArray
    by_inputs: FloatArray
    by_coefficients: FloatArray

    @property
    def inputs(self) -> tuple[float, float, float]:
        """Port and starboard warp length (m) and speed (m/s)."""
        return self.state[0], self.state[0], self.state[1]

    def __getitem__(self, name: str) -> float:
        return float(self.values[OBSERVABLES.index(name)])


@dataclass(frozen=True)
class TowedBoard:
    """Board that tows in all states of a trial, its observables tow by tow, and how many
    were drawn that do not, by reason.
    """

    coefficients: FloatArray
    tows: tuple[tuple[Look, ...], ...]
    rejected: Counter[str]


def draw_board(
    gear: GearRecord,
    prior: ParameterVector,
    tows: tuple[tuple[State, ...], ...],
    chance: np.random.Generator,
) -> TowedBoard:
    """Draw coefficients from the prior until the gear can be towed with them.

    Parameters
    ----------
    gear
        The plant.
    prior
        Normal, cut at its bounds.
    tows
        The steady states in which the gear must be usable: stable, under water, and its boards
        within the range of their law.
    chance
        Generator of random numbers.

    Raises
    ------
    TrawlError
        If none of `MOST_DRAWS` boards tows.
    """
    model = build_model(gear)
    states = sorted(set(chain.from_iterable(tows)), key=lambda state: (state[1], -state[0]))
    rejected: Counter[str] = Counter()
    for _ in range(MOST_DRAWS):
        drawn = prior.start + prior.std * chance.standard_normal(len(prior.start))
        if not np.all((prior.low <= drawn) & (drawn <= prior.high)):
            rejected['out of bounds'] += 1
            continue
        board = model.with_coefficients(drawn)
        found: dict[State, Equilibrium] = {}
        try:
            # The slowest first: there most boards fall over, with long warps and with short ones.
            for state in states:
                near = _nearest(found, state)
                point = OperatingPoint(state[0], state[0], state[1])
                found[state] = find_equilibrium(board, point, near)
                require_usable(board, found[state])
        except NoSteadyState as refusal:
            rejected[refusal.reason] += 1
            continue
        looks = {}
        for state, equilibrium in found.items():
            jacobian = sensitivities(board, equilibrium)
            looks[state] = Look(
                state, equilibrium.observables.array(), jacobian[:, 12:], jacobian[:, :12]
            )
        return TowedBoard(
            drawn, tuple(tuple(looks[state] for state in tow) for tow in tows), rejected
        )
    reasons = ', '.join(f'{reason} {count}' for reason, count in rejected.most_common())
    raise TrawlError(f'none of {MOST_DRAWS} boards drawn from the prior can be towed ({reasons})')


def _nearest(found: dict[State, Equilibrium], state: State) -> Equilibrium | None:
    if not found:
        return None
    near = min(found, key=lambda other: abs(other[0] / state[0] - 1) + abs(other[1] / state[1] - 1))
    return found[near]
