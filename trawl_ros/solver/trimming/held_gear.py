# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Gear with boards held at one attitude: its shapes at several operating points."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.observables import observe
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.cold_start import bowed
from trawl_ros.solver.equilibrium import with_effects
from trawl_ros.solver.first_guess import (
    attitudes,
    coarser_model,
    first_guess,
    shifted_to,
)
from trawl_ros.solver.operating_point import steady_tow
from trawl_ros.solver.relax import relax, without_attitude
from trawl_ros.solver.trim import roll_for
from trawl_ros.solver.trimming.held_boards import HeldBoard, held_board

SHAPE_FORCE_N, SHAPE_ITERATIONS = 1.0, 300
"""Force left at which a shape is converged, and iterations after which it is given up."""

BOW_PRESSURES_PA = 0.0, 300.0, 1000.0, 600.0, 2000.0
"""Loads across twine, tried in this order: with bowed twine a shape is found more easily, and its
pull on the bridles is nearly the same."""

FIRST_TIME_STEPS_S = 2.0, 0.5
"""First time steps of the search for a shape, tried in this order."""


def coarsest_model(model: GearModel) -> GearModel:
    """Return the gear with the coarsest net of a cold start."""
    while (coarser := coarser_model(model)) is not None:
        model = coarser
    return model


def attitude_at(
    model: GearModel, place: tuple[float, float], attack: float, inclination: float, pitch: float
) -> FloatArray:
    """Return the rotations (2, 3, 3) with these angles in a steady tow."""
    roll = roll_for(inclination, pitch)
    acting, point = with_effects(model, (place[0], place[0]), place[1])
    tow = steady_tow(acting, point)
    guess = first_guess(acting, tow, point.heading)

    def excess(yaw: float) -> float:
        turned = replace(guess, board_rotations=attitudes(yaw, pitch, roll))
        return float(observe(acting, turned, tow).port_attack) - attack

    return attitudes(float(brentq(excess, attack - 0.5, attack + 0.5)), pitch, roll)


class HeldGear:
    """Gear with boards held at one attitude at all operating points."""

    def __init__(
        self, model: GearModel, rotations: FloatArray, places: Sequence[tuple[float, float]]
    ) -> None:
        self.model, self.places = model, places
        self.turn = rotations[0]
        self.acting: list[tuple[GearModel, Tow]] = []
        self._loads: list[float] = []
        self.states: list[State] = []
        for warp, speed in places:
            acting, point = with_effects(model, (warp, warp), speed)
            tow = steady_tow(acting, point)
            guess = replace(first_guess(acting, tow, point.heading), board_rotations=rotations)
            loose, state = self._first(acting, tow, guess, (warp, speed))
            self.acting.append((loose, tow))
            self.states.append(state)

    def _first(
        self, model: GearModel, tow: Tow, guess: State, place: tuple[float, float]
    ) -> tuple[GearModel, State]:
        """Find a shape with the least bowed twine, from a guess or another operating point.

        Returns the gear with this twine, and the shape.
        """
        refused: NoSteadyState | None = None
        known = sorted(range(len(self.states)), key=lambda n: self._apart(place, self.places[n]))
        for pressure in BOW_PRESSURES_PA:
            loose = bowed(model, pressure)
            near = [
                shifted_to(self.acting[n][0], self.states[n], self.acting[n][1], tow)
                for n in known[:1]
            ]
            for start in (guess, *near):
                try:
                    shape = _shape(loose, start, tow, place)
                    self._loads.append(pressure)
                    return loose, shape
                except NoSteadyState as reason:
                    refused = reason
        assert refused is not None
        raise refused

    @staticmethod
    def _apart(a: tuple[float, float], b: tuple[float, float]) -> float:
        """Return the distance of two operating points, in logarithms."""
        return float(np.abs(np.log(a) - np.log(b)).sum())

    def regeared(self, model: GearModel) -> None:
        """Replace the gear by a changed one with the same nodes; keep the shapes."""
        self.model = model
        for number, (warp, speed) in enumerate(self.places):
            acting, _ = with_effects(model, (warp, warp), speed)
            self.acting[number] = (bowed(acting, self._loads[number]), self.acting[number][1])

    def turned(self, rotations: FloatArray, points: FloatArray) -> None:
        """Hold the boards at other rotations (2, 3, 3) and find the shapes."""
        turned = [replace(state, board_rotations=rotations) for state in self.states]
        self.states, self.turn = self.shapes(points, turned), rotations[0]

    def shapes(self, points: FloatArray, near: Sequence[State]) -> list[State]:
        """Find the shapes with these points (3, 3), from others nearby."""
        return [
            _shape(acting.with_board(points=points), state, tow, place)
            for (acting, tow), state, place in zip(self.acting, near, self.places, strict=True)
        ]

    def boards(self, points: FloatArray) -> list[HeldBoard]:
        """Find the shapes with these points, and return the port board at each operating point."""
        self.states = self.shapes(points, self.states)
        return [
            held_board(acting.with_board(points=points), state, tow)
            for (acting, tow), state in zip(self.acting, self.states, strict=True)
        ]

    def arms(self, points: FloatArray) -> FloatArray:
        """Return arms (3, 3) in fixed axes of points in the outward frame."""
        arms: FloatArray = points @ self.model.board.installed @ self.turn.T
        return arms


def _shape(model: GearModel, state: State, tow: Tow, place: tuple[float, float]) -> State:
    """Find the shape of the gear with its boards held at their attitudes."""
    free, left = without_attitude(model), np.inf
    for first in FIRST_TIME_STEPS_S:
        found, _, left = relax(
            model,
            state,
            tow,
            tolerance=SHAPE_FORCE_N,
            time_step=first,
            free=free,
            limit=SHAPE_ITERATIONS,
        )
        if left <= SHAPE_FORCE_N:
            return found
    raise NoSteadyState(
        f'warp {place[0]:g} m at {place[1]:.4g} m/s: the gear has no shape with the boards held '
        f'at the wanted angles, {left:.3g} N left'
    )
