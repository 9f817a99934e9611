# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Plants of the blind cases, the models fitted to them, and the observables of drawn boards."""

from dataclasses import dataclass
from itertools import chain

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.sensitivity import sensitivities
from trawl_ros.solver.trimming.drawn_board import DrawnBoard, draw_board

State = tuple[float, float]
"""Warp length (m) and speed (m/s) of a steady state."""


@dataclass(frozen=True)
class MeshResolution:
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
class LinearisedState:
    """Steady state of the plant, linearised.

    ``values`` are the observables (22,). ``by_inputs`` (22, 3) is their Jacobian for both warp
    lengths and speed, ``by_coefficients`` (22, 12) that for the coefficients.
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
    """Board that tows in all states of a trial, and its observables tow by tow."""

    drawn: DrawnBoard
    tows: tuple[tuple[LinearisedState, ...], ...]


def towed_board(
    gear: GearRecord, tows: tuple[tuple[State, ...], ...], rng: np.random.Generator
) -> TowedBoard:
    """Draw boards until one tows in all states of a trial.

    Parameters
    ----------
    gear
        The plant.
    tows
        The steady states, tow by tow.
    rng
        Generator of random numbers.

    Raises
    ------
    TrawlError
        If none of the boards drawn tows.
    """
    drawn = draw_board(gear, list(chain.from_iterable(tows)), rng)
    looks = {}
    for state, equilibrium in drawn.steady.items():
        jacobian = sensitivities(drawn.model, equilibrium)
        values = equilibrium.observables.array()
        looks[state] = LinearisedState(state, values, jacobian[:, 12:], jacobian[:, :12])
    return TowedBoard(drawn, tuple(tuple(looks[state] for state in tow) for tow in tows))
