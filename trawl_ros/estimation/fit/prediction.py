# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Protocols of predictors: the estimator's interface to a model of the gear."""

from typing import TYPE_CHECKING, Protocol, runtime_checkable

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.windows.records import SteadyWindow

if TYPE_CHECKING:
    from trawl_ros.solver.equilibrium import Equilibrium


class SteadyPrediction(Protocol):
    """Prediction of a steady state."""

    @property
    def values(self) -> FloatArray:
        """Observables (n,), SI."""
        ...

    @property
    def jacobian(self) -> FloatArray:
        """Derivatives (n, q + 3) of the observables by coefficients, warp lengths and speed."""
        ...

    @property
    def slow(self) -> FloatArray:
        """Slow mode in each observable (n,), per m of net depth."""
        ...

    @property
    def state(self) -> 'Equilibrium':
        """Start value for a nearby solution."""
        ...


class SteadyPredictor(Protocol):
    """Predictor of the gear's steady state."""

    def predict(
        self,
        coefficients: FloatArray,
        port_length: float,
        starboard_length: float,
        speed: float,
        start: 'Equilibrium | None' = None,
    ) -> SteadyPrediction:
        """Solve for coefficients (q,), warp lengths (m) and speed (m/s).

        Raises
        ------
        NoSteadyState
            If there is none.
        """
        ...


@runtime_checkable
class WindowPredictor(SteadyPredictor, Protocol):
    """Predictor that depends on more of a window than warp lengths and speed."""

    def in_window(self, window: SteadyWindow) -> SteadyPredictor:
        """Return the predictor for this window."""
        ...


@runtime_checkable
class NetPredictor(SteadyPredictor, Protocol):
    """Predictor with factors on drag and weight of the net."""

    def with_net(self, drag: float, weight: float) -> 'NetPredictor':
        """Return the predictor with these factors on the net's drag and weight in water."""
        ...

    def by_net(
        self, coefficients: FloatArray, inputs: FloatArray, steady: 'Equilibrium'
    ) -> FloatArray:
        """Derivatives (n, 2) by factors on drag and weight at a prediction's ``state``."""
        ...
