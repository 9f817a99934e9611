"""One window beside the model: what was predicted, and how it changes."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from trawl_ros.errors import NoSteadyState
from trawl_ros.identification.channels import INPUTS, MEASURED
from trawl_ros.identification.prediction import Predictor
from trawl_ros.identification.window_records import SteadyWindow


@dataclass(frozen=True)
class Linearised:
    """The model around coefficients ``at`` (12,) at one window's measured inputs.

    ``channels`` are the n measured channels the window has; ``measured``, ``values`` (n,),
    ``by_coefficients`` (n, 12) and ``by_inputs`` (n, 3) in SI; ``state`` starts the solver.
    """

    window: SteadyWindow
    channels: tuple[str, ...]
    at: np.ndarray
    measured: np.ndarray
    values: np.ndarray
    by_coefficients: np.ndarray
    by_inputs: np.ndarray
    slow: np.ndarray
    state: Any

    def predicted(self, coefficients: np.ndarray) -> np.ndarray:
        """Values (n,) at other coefficients, to first order."""
        return self.values + self.by_coefficients @ (coefficients - self.at)

    def std(self, windows_in_state: int) -> np.ndarray:
        """Standard deviations (n,) of the measured means."""
        return np.array([self.window.std(name, windows_in_state) for name in self.channels])


def linearise(
    predictor: Predictor,
    observables: Sequence[str],
    window: SteadyWindow,
    coefficients: np.ndarray,
    starts: Sequence[Any] = (None,),
) -> Linearised:
    """Solve the model at a window's inputs, trying each of ``starts`` in turn.

    Raises
    ------
    NoSteadyState
        When none of the starts leads to one.
    """
    channels = tuple(name for name in MEASURED if name in window.means and name in observables)
    rows = [observables.index(name) for name in channels]
    port, starboard, speed = (window.means[name] for name in INPUTS)
    failure: NoSteadyState | None = None
    for start in starts:
        try:
            prediction = predictor.predict(coefficients, port, starboard, speed, start)
        except NoSteadyState as error:
            failure = error
            continue
        jacobian = prediction.jacobian[rows]
        return Linearised(
            window=window,
            channels=channels,
            at=np.array(coefficients),
            measured=np.array([window.means[name] for name in channels]),
            values=prediction.values[rows],
            by_coefficients=jacobian[:, :-3],
            by_inputs=jacobian[:, -3:],
            slow=prediction.slow[rows],
            state=prediction.state,
        )
    raise failure or NoSteadyState('no start was given to look for a steady state from')
