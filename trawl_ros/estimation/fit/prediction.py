"""Protocols of predictors: the estimator's interface to a model of the gear."""

from typing import Any, Protocol, runtime_checkable

import numpy as np

from trawl_ros.estimation.windows.records import SteadyWindow


class SteadyPrediction(Protocol):
    """Prediction of a steady state."""

    @property
    def values(self) -> np.ndarray:
        """Observables (n,), SI."""
        ...

    @property
    def jacobian(self) -> np.ndarray:
        """Derivatives (n, 15) of the observables by coefficients, both warp lengths and speed."""
        ...

    @property
    def slow(self) -> np.ndarray:
        """Slow mode in each observable (n,), per m of net depth."""
        ...

    @property
    def state(self) -> Any:
        """Start value for a nearby solution."""
        ...


class SteadyPredictor(Protocol):
    """Predictor of the gear's steady state."""

    def predict(
        self,
        coefficients: np.ndarray,
        port_length: float,
        starboard_length: float,
        speed: float,
        start: Any = None,
    ) -> SteadyPrediction:
        """Solve for coefficients (12,), warp lengths (m) and speed (m/s).

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

    def by_net(self, coefficients: np.ndarray, inputs: np.ndarray, found: Any) -> np.ndarray:
        """Derivatives (n, 2) by factors on drag and weight at a prediction's ``state``."""
        ...
