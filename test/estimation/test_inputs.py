"""Warps that counters show unequal are solved at the lengths they are taken for."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.estimation.fit.estimator import Estimator
from trawl_ros.estimation.fit.linearised import linearise, measured_inputs

APART = 4.0
"""By so much (m) the port counter reads more than the starboard one."""


class Askew:
    """A closed form that feels the difference of its warps: the door of the longer one sinks by
    3 m per m, and the spread bends by 0.5 m per m².
    """

    def __init__(self, sea, most=np.inf):
        self.inner, self.most = sea.ClosedForm(), most
        self.spread = sea.OBSERVABLES.index('door_spread')
        self.doors = [sea.OBSERVABLES.index(f'{side}_door_depth') for side in ('port', 'starboard')]
        self.places = []

    def predict(self, coefficients, port_length, starboard_length, speed, start=None):
        apart = port_length - starboard_length
        self.places.append(apart)
        if abs(apart) > self.most:
            raise NoSteadyState('towed askew')
        found = self.inner.predict(coefficients, port_length, starboard_length, speed, start)
        values, jacobian = found.values.copy(), found.jacobian.copy()
        values[self.spread] -= 0.5 * apart**2
        jacobian[self.spread, -3:-1] += (-apart, apart)
        for row, sign in zip(self.doors, (3.0, -3.0), strict=True):
            values[row] += sign * apart
            jacobian[row, -3:-1] += (sign, -sign)
        return replace(found, values=values, jacobian=jacobian)


@pytest.fixture
def askew_windows(sea):
    """A trial towed straight, without errors but in the counters."""
    windows = sea.trial_windows(sea.ClosedForm(), np.random.default_rng(0), noise=0.0)
    shift = {'port_length': 0.5 * APART, 'starboard_length': -0.5 * APART}
    return [
        replace(w, means={name: mean + shift.get(name, 0.0) for name, mean in w.means.items()})
        for w in windows
    ]


def fitted(model, prior, sea, windows):
    estimator = Estimator(model, prior, sea.OBSERVABLES)
    for window in windows:
        estimator.add(window)
    return estimator, estimator.finish()


@pytest.mark.parametrize('most', [np.inf, 3.0])
def test_unequal_counters_of_a_gear_towed_straight_are_seen_through(
    sea, prior, askew_windows, most
):
    model = Askew(sea, most)
    estimator, estimate = fitted(model, prior, sea, askew_windows)
    assert estimate.converged, estimate.reason
    assert estimate.windows == len(askew_windows)
    apart = np.diff(estimator.fit.inputs[:, :2], axis=1)
    assert np.max(np.abs(apart)) < 0.3 * APART
    # Eight metres of spread, 6 % at 0.1 per std, would move them by half a std.
    assert np.max(np.abs((estimate.values - sea.TRUTH) / sea.STD)) < 0.1


def test_solved_where_it_was_measured_the_same_trial_misleads(sea, prior, askew_windows):
    # What first order around the counters' readings makes of it.
    model = Askew(sea)
    _, estimate = fitted(model, prior, sea, askew_windows)
    first = linearise(model, sea.OBSERVABLES, askew_windows[0], estimate.values)
    there = linearise(
        model, sea.OBSERVABLES, askew_windows[0], estimate.values,
        inputs=np.array([200.0, 200.0, 1.8]),
    )  # fmt: skip
    row = first.channels.index('door_spread')
    exact = sea.ClosedForm().predict(estimate.values, 200.0, 200.0, 1.8).values[model.spread]
    back = np.array([-0.5 * APART, 0.5 * APART, 0.0])
    assert first.values[row] + first.by_inputs[row] @ back == pytest.approx(exact + 8.0, abs=0.01)
    assert there.values[row] + there.by_inputs[row] @ back == pytest.approx(exact, abs=0.01)


def test_values_are_those_of_the_measured_inputs_to_first_order(sea, prior, askew_windows):
    model = Askew(sea)
    window = askew_windows[3]
    inputs = measured_inputs(window) + np.array([0.3, -0.2, 0.01])
    found = linearise(model, sea.OBSERVABLES, window, prior.start, inputs=inputs)
    np.testing.assert_array_equal(found.inputs, inputs)
    solved = model.predict(prior.start, *inputs)
    rows = [sea.OBSERVABLES.index(name) for name in found.channels]
    expected = solved.values[rows] + found.by_inputs @ (measured_inputs(window) - inputs)
    np.testing.assert_allclose(found.values, expected, rtol=1e-12)


def test_where_no_gear_could_be_towed_so_the_mean_length_is_tried(sea, prior, askew_windows):
    model = Askew(sea, most=3.0)
    found = linearise(model, sea.OBSERVABLES, askew_windows[0], prior.start)
    assert model.places == [APART, 0.0]
    assert found.inputs[0] == found.inputs[1] == 200.0
    with pytest.raises(NoSteadyState, match='askew'):
        linearise(model, sea.OBSERVABLES, askew_windows[0], prior.start, even=False)
