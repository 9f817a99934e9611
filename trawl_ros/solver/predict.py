# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Predictions of sensor readings in steady towing, with their derivatives, for identification.

The gear may have effects beyond the model. Their values can be estimated along with the board's
coefficients.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Situation
from trawl_ros.effects.effect_set import NO_EFFECTS, ActiveEffect, EffectSet
from trawl_ros.model.gear_model import GearModel
from trawl_ros.solver.effect_sensitivity import by_effects, chained, sensor_slopes, shown_values
from trawl_ros.solver.equilibrium import Equilibrium, find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint
from trawl_ros.solver.sensitivity import net_sensitivities, sensitivities
from trawl_ros.solver.slow_mode import slow_mode

ANYWHERE = Situation((0.0, 0.0, 0.0))


@dataclass(frozen=True)
class Prediction:
    """Predicted readings of a window with their derivatives.

    Attributes
    ----------
    values : (n_observables,) array
        Readings as sensors show them.
    jacobian : (n_observables, q + m + 3) array
        Derivatives by the q coefficients, the m values of free effects, and `INPUTS`.
    slow : (n_observables,) array
        Shape of the slowest mode, per metre of net depth.
    state
        Equilibrium from which the next prediction nearby can start.
    """

    values: FloatArray
    jacobian: FloatArray
    slow: FloatArray
    state: Equilibrium


class TowStretch(Protocol):
    """Covariates of a towing window that effects may depend on."""

    @property
    def tow(self) -> int:
        """Number of the tow."""
        ...

    @property
    def hours(self) -> float:
        """Time since the tow began, h."""
        ...

    @property
    def sense(self) -> float:
        """Course sense on the ship's track, as `trawl_ros.effects.base.effect.sense` has it."""
        ...


@dataclass(frozen=True)
class Predictor:
    """Equilibrium model of a gear as a function of coefficients, operating point and effects.

    Attributes
    ----------
    model
        The gear without effects.
    fixed
        Effects that act with known values.
    free
        Effects whose values follow the coefficients.
    at
        Situation of the prediction, except for warp lengths and speed.
    without
        Tows in which the free effects do not act.
    new
        Names of fixed effects that do not act in these tows either.
    absent
        True in the predictor of one of these tows.
    """

    model: GearModel
    fixed: EffectSet = NO_EFFECTS
    free: tuple[Effect, ...] = ()
    at: Situation = ANYWHERE
    without: frozenset[int] = frozenset()
    new: frozenset[str] = frozenset()
    absent: bool = False
    _last: dict[bytes, Prediction] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    def acting(self, coefficients: FloatArray) -> EffectSet:
        """Return the effect set with the values that follow the coefficients."""
        there = self.fixed.without(self.new) if self.absent else self.fixed
        place = len(self.model.coefficients)
        for effect in self.free:
            number = len(effect.parameters)
            if not self.absent:
                there = there.having(ActiveEffect(effect, coefficients[place : place + number]))
            place += number
        return there

    def in_window(self, window: TowStretch) -> 'Predictor':
        """Return the predictor for a window; itself if there are no effects."""
        return self.situated(window) if self.fixed or self.free else self

    def situated(self, window: TowStretch) -> 'Predictor':
        """Return the predictor in the situation of a window of steady towing."""
        at = Situation((0.0, 0.0, 0.0), sense=window.sense, hours=window.hours)
        return replace(self, at=at, absent=window.tow in self.without)

    def gear(self, coefficients: FloatArray, inputs: FloatArray) -> GearModel:
        """Return the gear model with its effects, where counters and log show ``inputs`` (3,)."""
        board = self._with_board(coefficients)
        return self.acting(coefficients).gear(board, self._situation(inputs))

    def _with_board(self, coefficients: FloatArray) -> GearModel:
        return self.model.with_coefficients(coefficients[: len(self.model.coefficients)])

    def with_net(self, drag: float, weight: float) -> 'Predictor':
        """Return the predictor with these factors on drag and weight in water of the net."""
        return replace(self, model=self.model.with_net(drag, weight))

    def by_net(
        self, coefficients: FloatArray, inputs: FloatArray, found: Equilibrium
    ) -> FloatArray:
        """Return derivatives (n_observables, 2) by factors on drag and weight in water of the net.

        Parameters
        ----------
        coefficients, inputs, found
            Arguments of a prediction, and its steady state.
        """
        acting = self.acting(coefficients)
        by_net = net_sensitivities(self.gear(coefficients, inputs), found)
        return sensor_slopes(acting, found.observables.array(), self._situation(inputs)) @ by_net

    def _situation(self, inputs: FloatArray) -> Situation:
        port, starboard, speed = map(float, inputs)
        return replace(self.at, inputs=(port, starboard, speed))

    def predict(
        self,
        coefficients: FloatArray,
        port_length: float,
        starboard_length: float,
        speed: float,
        start: Equilibrium | None = None,
    ) -> Prediction:
        """Predict the readings of a steady state, with their derivatives.

        Parameters
        ----------
        coefficients : (q + m,) array
            Of the boards, in the order of their law, and the values of the free effects.
        port_length, starboard_length, speed
            Warp lengths as counters show them (m), and speed as the log shows it (m/s).
        start
            ``state`` of an earlier prediction nearby; without it a cold start is made.

        Raises
        ------
        NoSteadyState
            If the gear has none there.
        """
        question = np.array([*coefficients, port_length, starboard_length, speed]).tobytes()
        last = self._last.pop(question, None)
        self._last.clear()
        if last is not None:
            # A window is checked before it is used; do not solve it twice.
            return last
        inputs = np.array([port_length, starboard_length, speed])
        at, acting = self._situation(inputs), self.acting(coefficients)
        board = self._with_board(coefficients)
        gear = acting.gear(board, at)
        port, starboard, through = map(float, acting.apply_to_inputs(inputs, at))
        point = OperatingPoint(port, starboard, through)
        found = find_equilibrium(gear, point, start, cold=start is None)
        values, jacobian = found.observables.array(), sensitivities(gear, found)
        shown = chained(board, gear, found, jacobian, acting, inputs, at)
        extra = np.zeros((len(values), len(coefficients) - len(board.coefficients)))
        if self.free and not self.absent:
            wanted = [acting.of(effect) for effect in self.free]
            extra = by_effects(board, gear, found, jacobian, acting, wanted, inputs, at)
        answer = Prediction(
            shown_values(acting, values, at),
            np.hstack((shown[:, :-3], extra, shown[:, -3:])),
            slow_mode(gear, found).shape,
            found,
        )
        self._last[question] = answer
        return answer

    def signatures(
        self,
        coefficients: FloatArray,
        inputs: FloatArray,
        found: Equilibrium,
        wanted: Sequence[ActiveEffect],
    ) -> FloatArray:
        """Return signatures of effects: changes of the readings (n_observables, m) per unit.

        Parameters
        ----------
        coefficients, inputs
            Coefficients (q,), and warp lengths and speed (3,) of a prediction.
        found
            Its equilibrium.
        wanted
            Effects whose signatures are wanted.
        """
        at, acting = self._situation(inputs), self.acting(coefficients)
        board = self._with_board(coefficients)
        gear = acting.gear(board, at)
        jacobian = sensitivities(gear, found)
        return by_effects(board, gear, found, jacobian, acting, wanted, inputs, at)
