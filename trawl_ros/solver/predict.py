"""Predictions of what a tow shows, with their derivatives: what identification asks for."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.model.gear_model import GearModel
from trawl_ros.solver.equilibrium import Equilibrium, find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint
from trawl_ros.solver.sensitivity import net_sensitivities, sensitivities
from trawl_ros.solver.slow_mode import slow_mode


@dataclass(frozen=True)
class Prediction:
    """``values`` (n_observables,) and ``jacobian`` (n_observables, 15) by `PARAMETERS`; ``slow``
    (n_observables,) is how the gear comes to rest, per metre of net depth; ``state`` is what the
    next prediction nearby may start from.
    """

    values: np.ndarray
    jacobian: np.ndarray
    slow: np.ndarray
    state: Equilibrium


class Predictor:
    """The equilibrium model of one gear as a function of coefficients and operating point."""

    def __init__(self, model: GearModel) -> None:
        self.model = model
        self._last: tuple[bytes, Prediction] | None = None

    def with_net(self, drag: float, weight: float) -> 'Predictor':
        """The predictor of a gear whose net has this many times the drag and weight in water."""
        return Predictor(self.model.with_net(drag, weight))

    def by_net(self, coefficients: np.ndarray, found: Equilibrium) -> np.ndarray:
        """Derivatives (n_observables, 2) by factors on drag and weight in water of the net.

        Parameters
        ----------
        coefficients, found
            Of a prediction, which has the steady state.
        """
        return net_sensitivities(self.model.with_coefficients(coefficients), found)

    def predict(
        self,
        coefficients: np.ndarray,
        port_length: float,
        starboard_length: float,
        speed: float,
        start: Equilibrium | None = None,
    ) -> Prediction:
        """Observables and their derivatives at a steady state.

        Parameters
        ----------
        coefficients : (12,) array
            In the order of `COEFFICIENTS`.
        port_length, starboard_length
            Warp lengths, m.
        speed
            Through the water, m/s.
        start
            The ``state`` of an earlier prediction nearby; a cold start is made without one only.

        Raises
        ------
        NoSteadyState
            When the gear has none there with these coefficients.
        """
        question = np.array([*coefficients, port_length, starboard_length, speed]).tobytes()
        last, self._last = self._last, None
        if last is not None and last[0] == question:
            # A window is looked at before it is used, which need not be solved for twice.
            return last[1]
        model = self.model.with_coefficients(coefficients)
        point = OperatingPoint(port_length, starboard_length, speed)
        found = find_equilibrium(model, point, start, cold=start is None)
        values, jacobian = found.observables.array(), sensitivities(model, found)
        answer = Prediction(values, jacobian, slow_mode(model, found).shape, found)
        self._last = question, answer
        return answer
