"""A short trial of each gear from a net plan: what its file does not say right is found."""

import numpy as np
import pytest

from trawl_ros.estimation.fit.estimator import Estimator
from trawl_ros.estimation.from_gear import identification_for
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.gear.load import load_gear
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.records.channels import CHANNELS, INPUTS, MEASURED
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.solver.equilibrium import find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint

TRIALS = {
    'krill_800': ((300.0, 1.2), (300.0, 1.4), (450.0, 1.3), (600.0, 1.2)),
    'krill_1600': ((300.0, 1.2), (300.0, 1.4), (450.0, 1.3), (600.0, 1.2)),
    'krill_1420': ((300.0, 1.1), (300.0, 1.3), (400.0, 1.2), (500.0, 1.1)),
    'harstad_1436': ((300.0, 1.3), (300.0, 1.5), (400.0, 1.4), (500.0, 1.5)),
    'four_seam': ((150.0, 1.2), (150.0, 1.6), (200.0, 1.4), (250.0, 1.2)),
}
"""Steady states of each trial: length of warp (m) and speed (m/s)."""

PAIR_TRIAL = ((150.0, 1.0), (150.0, 1.2), (200.0, 1.0), (220.0, 1.1))

HIDDEN = {'c1': 0.04, 'c2': 0.12}
"""Corrections of the boards at sea: more drag and more lift than the file says."""

DRAG = 1.2
"""Drag of the pair trawl's net at sea over that of its file."""


def feed(estimator: Estimator, plant: GearModel, states: tuple[tuple[float, float], ...]) -> None:
    """Give the estimator a window of each steady state of the plant."""
    near = None
    for index, (length, speed) in enumerate(states):
        near = find_equilibrium(plant, OperatingPoint(length, length, speed), near)
        means = {name: getattr(near.observables, name) for name in MEASURED}
        means |= dict(zip(INPUTS, (length, length, speed), strict=True))
        bias = {name: CHANNELS[name].bias_std(mean) for name, mean in means.items()}
        noise = {name: 0.1 * size for name, size in bias.items()}
        start, counts = index * 10**12, dict.fromkeys(means, 60)
        estimator.add(
            SteadyWindow(index, index, start, start + 6 * 10**10, means, noise, bias, counts)
        )


@pytest.mark.slow
@pytest.mark.parametrize('name', TRIALS)
def test_lift_of_the_boards_is_found_where_they_work(name: str) -> None:
    gear = load_gear(name).refined(net=0.4)
    estimator = identification_for(gear).estimator
    truth = np.array([HIDDEN.get(key, 0.0) for key in COEFFICIENTS])
    feed(estimator, build_model(gear).with_coefficients(truth), TRIALS[name])
    estimate = estimator.finish()
    assert estimate.converged, estimate.reason
    working = np.array([0.0, 0.0, np.radians(16.0), 1.0, *np.zeros(8)])
    spread = np.sqrt(working @ estimate.covariance @ working)
    assert working @ estimate.values == pytest.approx(working @ truth, abs=2.0 * spread)
    assert spread < 0.7 * np.sqrt(working**2 @ estimator.prior.std**2)


@pytest.mark.slow
def test_drag_of_the_pair_trawls_net_is_found() -> None:
    gear = load_gear('pair_368').refined(net=0.5)
    estimator = identification_for(gear).estimator
    feed(estimator, build_model(gear).with_net(DRAG, 1.0), PAIR_TRIAL)
    drag, _ = estimator.finish().net
    assert drag.value == pytest.approx(DRAG, abs=2.0 * drag.std)
    assert drag.std < 0.5 * drag.known
