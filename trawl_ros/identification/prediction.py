"""What the estimator asks of a model of the gear."""

from typing import Any, Protocol, runtime_checkable

import numpy as np

from trawl_ros.identification.window_records import SteadyWindow


class Prediction(Protocol):
    """A steady state."""

    @property
    def values(self) -> np.ndarray:
        """The observables (n,), SI."""
        ...

    @property
    def jacobian(self) -> np.ndarray:
        """Their derivatives (n, 15) by the coefficients, both warp lengths and speed."""
        ...

    @property
    def slow(self) -> np.ndarray:
        """What each observable (n,) shows of the gear's coming to rest, per m of net depth."""
        ...

    @property
    def state(self) -> Any:
        """Where a near-by solution may start from."""
        ...


class Predictor(Protocol):
    """Finds the steady state of the gear."""

    def predict(
        self,
        coefficients: np.ndarray,
        port_length: float,
        starboard_length: float,
        speed: float,
        start: Any = None,
    ) -> Prediction:
        """Solve for coefficients (12,), warp lengths (m) and speed (m/s).

        Raises
        ------
        NoSteadyState
            When there is none.
        """
        ...


@runtime_checkable
class WindowPredictor(Predictor, Protocol):
    """One whose predictions depend on more of a window than warp lengths and speed."""

    def in_window(self, window: SteadyWindow) -> Predictor:
        """The predictor for this window."""
        ...


@runtime_checkable
class NetPredictor(Predictor, Protocol):
    """One that knows what its net does."""

    def with_net(self, drag: float, weight: float) -> 'NetPredictor':
        """The predictor of a gear whose net has this many times the drag and weight in water."""
        ...

    def by_net(self, coefficients: np.ndarray, inputs: np.ndarray, found: Any) -> np.ndarray:
        """Derivatives (n, 2) by factors on drag and weight at a prediction's ``state``."""
        ...
