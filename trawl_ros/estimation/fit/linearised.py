# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Linearised window: its predictions and their derivatives."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.core.arrays import FloatArray, Slice
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.estimation.fit.objective import PAPER_CHANNELS, paper_values, stack
from trawl_ros.estimation.fit.prediction import NetPredictor, SteadyPredictor, WindowPredictor
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.records.channels import INPUTS, MEASURED

if TYPE_CHECKING:
    from trawl_ros.solver.equilibrium import Equilibrium


@dataclass(frozen=True)
class Linearised:
    """Linearisation of a window where it was solved.

    It was solved at coefficients ``at`` (q,), ``inputs`` (3,) and ``net`` (2,); the last are
    factors on drag and weight in water of the net.
    ``channels`` are the n measured channels the window has; ``measured``, ``values`` (n,),
    ``by_coefficients`` (n, q, or more where more is estimated along), ``by_inputs`` (n, 3) and
    ``by_net`` (n, 2; 0 where the net is held) in SI; ``state`` starts the solver. The values are
    those of the measured inputs and of the net in the gear file, to first order: warp lengths are
    measured with errors that differ between the sides, and a gear that is towed askew is not linear
    in them.
    """

    window: SteadyWindow
    channels: tuple[str, ...]
    at: FloatArray
    inputs: FloatArray
    net: FloatArray
    measured: FloatArray
    values: FloatArray
    by_coefficients: FloatArray
    by_inputs: FloatArray
    by_net: FloatArray
    slow: FloatArray
    state: 'Equilibrium'

    def predicted(self, coefficients: FloatArray) -> FloatArray:
        """Predictions (n,) at other coefficients, to first order."""
        return self.values + self.by_coefficients @ (coefficients - self.at)

    @property
    def solved(self) -> FloatArray:
        """Predictions (n,) with the net as it was when they were solved."""
        return self.values + self.by_net @ (self.net - 1.0)

    def only(self, columns: Slice) -> 'Linearised':
        """Linearisation by some of the parameters; the others stay where it was solved."""
        return replace(self, at=self.at[columns], by_coefficients=self.by_coefficients[:, columns])

    def followed_by(self, values: FloatArray, columns: FloatArray) -> 'Linearised':
        """Linearisation by m more parameters: at these values (m,), with these columns (n, m)."""
        return replace(
            self,
            at=np.concatenate((self.at, values)),
            by_coefficients=np.hstack((self.by_coefficients, columns)),
        )

    def is_far(
        self,
        coefficients: FloatArray,
        inputs: FloatArray,
        net: FloatArray | None,
        threshold: float,
    ) -> bool:
        """Return True if readings move by more than a threshold to first order.

        Parameters
        ----------
        coefficients, inputs, net
            Other point: (q,), warp lengths and speed (3,), factors on the net's drag and weight
            (2,) or None where these are held.
        threshold
            Standard deviations of a window's mean.
        """
        change = self.by_coefficients @ (coefficients - self.at)
        change += self.by_inputs @ (inputs - self.inputs)
        if net is not None:
            change += self.by_net @ (net - self.net)
        return bool(np.max(np.abs(change) / self.std(1)) > threshold)

    def std(self, windows_in_state: int) -> FloatArray:
        """Standard deviations (n,) of the measured means."""
        return np.array([self.window.std(name, windows_in_state) for name in self.channels])


def linearise(
    predictor: SteadyPredictor,
    observables: Sequence[str],
    window: SteadyWindow,
    coefficients: FloatArray,
    starts: Sequence['Equilibrium | None'] = (None,),
    inputs: FloatArray | None = None,
    net: FloatArray | None = None,
    *,
    even: bool = True,
) -> Linearised:
    """Linearise the model at one window.

    Parameters
    ----------
    predictor, observables
        The model and the names of its values.
    window
        Steady window with the measured means.
    coefficients
        Point of linearisation (q,).
    starts
        Start states, each tried in turn; None is a cold start.
    inputs
        Warp lengths (m) and speed (m/s); as measured if None.
    net
        Factors (2,) on drag and weight of the net where these are estimated along.
    even
        True if a steady state may be one with both warps of their mean length, where there is
        none else: counters may read so unequal that no gear could be towed so.

    Raises
    ------
    NoSteadyState
        If none of the starts leads to one.
    """
    channels = tuple(name for name in MEASURED if name in window.means and name in observables)
    rows = [observables.index(name) for name in channels]
    stated = measured_inputs(window)
    wanted = stated if inputs is None else inputs
    failure: NoSteadyState | None = None
    if isinstance(predictor, WindowPredictor):
        predictor = predictor.in_window(window)
    there, by_net = np.ones(2), np.zeros((len(channels), 2))
    if net is not None:
        if not isinstance(predictor, NetPredictor):
            raise TypeError(f'{type(predictor).__name__} does not know what its net does')
        there, predictor = net, predictor.with_net(float(net[0]), float(net[1]))
    for start, at in product(starts, _places(wanted) if even else (wanted,)):
        try:
            port, starboard, speed = map(float, at)
            prediction = predictor.predict(coefficients, port, starboard, speed, start)
        except NoSteadyState as error:
            failure = error
            continue
        jacobian = prediction.jacobian[rows]
        by_inputs = jacobian[:, -3:]
        if isinstance(predictor, NetPredictor) and net is not None:
            by_net = predictor.by_net(coefficients, at, prediction.state)[rows] / net
        return Linearised(
            window=window,
            channels=channels,
            at=np.array(coefficients),
            inputs=np.array(at),
            net=np.array(there),
            measured=np.array([window.means[name] for name in channels]),
            values=prediction.values[rows] + by_inputs @ (stated - at) + by_net @ (1.0 - there),
            by_coefficients=jacobian[:, :-3],
            by_inputs=by_inputs,
            by_net=by_net,
            slow=prediction.slow[rows],
            state=prediction.state,
        )
    raise failure or NoSteadyState('no start was given to look for a steady state from')


def nearest_state(
    window: SteadyWindow, among: Sequence[Linearised | None]
) -> tuple['Equilibrium', ...]:
    """Steady state of the window whose inputs are nearest to those of another; none without any."""
    known = [linear for linear in among if linear is not None]
    if not known:
        return ()
    here = measured_inputs(window)
    away = [np.abs(here / measured_inputs(other.window) - 1.0).sum() for other in known]
    return (known[int(np.argmin(away))].state,)


def paper_rows(
    linearised: Sequence[Linearised | None], inputs: FloatArray | None = None
) -> FloatArray:
    """Predictions (n, 4) of the channels of eq. 35, NaN where there is no steady state.

    They are those at measured inputs, or to first order at ``inputs`` (n, 3).
    """
    rows = []
    for number, linear in enumerate(linearised):
        if linear is None:
            rows.append(np.full(len(PAPER_CHANNELS), np.nan))
            continue
        values = linear.solved
        if inputs is not None:
            values = values + linear.by_inputs @ (inputs[number] - measured_inputs(linear.window))
        rows.append(paper_values(dict(zip(linear.channels, values, strict=True))))
    return stack(rows)


def measured_inputs(window: SteadyWindow) -> FloatArray:
    """Warp lengths (m) and speed (m/s) of a window as measured, (3,)."""
    return np.array([window.means[name] for name in INPUTS])


def _places(inputs: FloatArray) -> tuple[FloatArray, ...]:
    if inputs[0] == inputs[1]:
        return (inputs,)
    mean = float(inputs[:2].mean())
    return inputs, np.array([mean, mean, inputs[2]])
