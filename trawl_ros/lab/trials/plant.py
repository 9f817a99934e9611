# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Plant of a trial: a gear that differs from the model, towed with hidden effects."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.trials.hidden_effects.hidden import Hidden
from trawl_ros.lab.trials.hidden_effects.on_deck import with_other_law
from trawl_ros.lab.trials.linearised_plant import LinearisedState, MeshResolution
from trawl_ros.lab.trials.tows import (
    FULL_PLAN,
    STATES,
    BlindTrialPlan,
    PlannedTow,
    State,
    nearest,
)
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.equilibrium import Equilibrium, find_equilibrium, require_usable
from trawl_ros.solver.operating_point import OperatingPoint
from trawl_ros.solver.sensitivity import sensitivities
from trawl_ros.solver.slow_mode import slow_mode
from trawl_ros.solver.trimming.drawn_board import BoardDraw, draw_board

FINER_MESH = MeshResolution(around=12, lines=2, unjoined=True)
"""Mesh resolution of plant and model of blind cases."""

BOARD_DRAW = BoardDraw(std_factor=0.5)
"""Boards are drawn with half of the prior's std.

This corresponds to a gear known from its drawing and an earlier trial.
"""


@dataclass(frozen=True)
class Clean:
    """Plant without hidden effects in one state; ``slow`` as in `Prediction`."""

    look: LinearisedState
    slow: FloatArray
    state: Equilibrium


@dataclass(frozen=True)
class Plant:
    """Plant with its own board, and its states without hidden effects."""

    model: GearModel
    coefficients: FloatArray
    clean: dict[State, Clean]

    def at(self, state: State) -> Clean:
        """Return the plant in a state without hidden effects.

        Raises
        ------
        NoSteadyState
            If it cannot be towed so.
        """
        if state not in self.clean:
            self.clean[state] = _solved(self.model, state, self.clean)
        return self.clean[state]

    def towed(
        self,
        effects: Sequence[tuple[Hidden, float]],
        plan: BlindTrialPlan = FULL_PLAN,
    ) -> tuple[tuple[LinearisedState, ...], ...]:
        """All tows with effects of some sizes hidden in those that are no baseline.

        Raises
        ------
        NoSteadyState
            If the gear cannot be towed so.
        """
        return tuple(
            tuple(
                self._linearised(tow, place, effects if number >= plan.baseline else ())
                for place in range(len(tow.states))
            )
            for number, tow in enumerate(plan.tows)
        )

    def _linearised(
        self, tow: PlannedTow, place: int, effects: Sequence[tuple[Hidden, float]]
    ) -> LinearisedState:
        at, clean = tow.moment(place), self.at(tow.states[place])
        inputs = np.array(at.inputs)
        gear, shown = self.model, inputs
        for hidden, size in effects:
            shown = hidden.towed(size, shown, at)
            gear = hidden.gear(size, gear, at)
        values = clean.look.values
        if gear is not self.model or not np.array_equal(shown, inputs):
            port, starboard, speed = map(float, shown)
            point = OperatingPoint(port, starboard, speed)
            found = require_usable(gear, find_equilibrium(gear, point, clean.state))
            values = found.equilibrium.observables.array()
        readings = dict(zip(OBSERVABLES, map(float, values), strict=True))
        for hidden, size in effects:
            readings = hidden.shown(size, readings, at)
        return replace(clean.look, values=np.array([readings[name] for name in OBSERVABLES]))


def _solved(model: GearModel, state: State, known: Mapping[State, Clean]) -> Clean:
    near = known[nearest(state, tuple(known))].state if known else None
    found = find_equilibrium(model, OperatingPoint(state[0], *state), near)
    require_usable(model, found)
    return _clean(model, state, found)


def _clean(model: GearModel, state: State, found: Equilibrium) -> Clean:
    by = sensitivities(model, found)
    look = LinearisedState(state, found.observables.array(), by[:, 12:], by[:, :12])
    return Clean(look, slow_mode(model, found).shape, found)


def draw_plant(
    gear: str,
    cut: MeshResolution,
    seed: int,
    number: int,
    states: Sequence[State] = STATES,
) -> Plant:
    """Draw a board that can be towed in all states: stable in each, not only solved.

    Parameters
    ----------
    gear, cut
        The gear, and how fine model and plant are.
    seed, number
        Of the study, and of the plant within it.
    states
        Steady states in which it must be towable.

    Raises
    ------
    TrawlError
        If none of many boards can be towed.
    """
    rng = np.random.default_rng([seed, number, *b'plant'])
    drawn = draw_board(cut.plant(gear), list(states), rng, BOARD_DRAW, build=_built)
    clean = {state: _clean(drawn.model, state, found) for state, found in drawn.steady.items()}
    return Plant(drawn.model, drawn.coefficients, clean)


def _built(record: GearRecord) -> GearModel:
    return with_other_law(build_model(record))
