"""Without boards drag and weight of the net are what is estimated, and what reports tell."""

import re

import pytest

from trawl_ros.estimation.fit.estimator import Estimator
from trawl_ros.estimation.from_gear import identification_for
from trawl_ros.estimation.pipeline import Identification
from trawl_ros.estimation.report.figures import drawings
from trawl_ros.estimation.report.page import report_page
from trawl_ros.estimation.report.report import report
from trawl_ros.estimation.report.table import closing_lines
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import build_model
from trawl_ros.records.channels import CHANNELS, INPUTS, MEASURED
from trawl_ros.solver.equilibrium import find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint

DRAG, WEIGHT = 1.2, 1.0
STATES = ((300.0, 1.4), (300.0, 1.7), (400.0, 1.5), (450.0, 1.7))


@pytest.fixture(scope='module')
def identification(pair_gear: GearRecord) -> Identification:
    """Fed with readings of a net with more drag than the file says, without errors."""
    plant = build_model(pair_gear).with_net(DRAG, WEIGHT)
    found, near, windows = identification_for(pair_gear), None, []
    for index, (length, speed) in enumerate(STATES):
        near = find_equilibrium(plant, OperatingPoint(length, length, speed), near)
        means = {name: getattr(near.observables, name) for name in MEASURED}
        means |= dict(zip(INPUTS, (length, length, speed), strict=True))
        bias = {name: CHANNELS[name].bias_std(mean) for name, mean in means.items()}
        noise = {name: 0.1 * std for name, std in bias.items()}
        counts, start = dict.fromkeys(means, 60), index * 10**12
        windows.append(
            SteadyWindow(index, index, start, start + 6 * 10**10, means, noise, bias, counts)
        )
    found.take(windows)
    found.estimator.finish()
    return found


@pytest.fixture(scope='module')
def estimator(identification: Identification) -> Estimator:
    return identification.estimator


def test_drag_of_the_net_is_found_and_no_coefficient_moves(estimator: Estimator) -> None:
    estimate = estimator.estimate
    assert estimate is not None
    drag, weight = estimate.net
    assert drag.value == pytest.approx(DRAG, abs=2.0 * drag.std)
    assert drag.value > 1.0 + 2.0 * drag.std
    assert drag.std < 0.3 * drag.known
    assert weight.value == pytest.approx(WEIGHT, abs=2.0 * weight.std)
    assert estimate.converged, estimate.reason
    assert estimate.values == pytest.approx(estimator.prior.start, abs=1e-4)


def test_the_report_tells_of_the_net_and_of_no_coefficient(
    identification: Identification, pair_gear: GearRecord
) -> None:
    told = report(identification, gear=pair_gear)
    sentences = ' '.join(closing_lines(told))
    assert 'no boards' in sentences
    assert re.search(r'Drag .*: 1\.', sentences)
    assert 'coefficients' not in sentences
    assert told.laws is None
    page = report_page(told, ())
    assert '<h1>Identification of the net</h1>' in page
    assert 'The coefficients' not in page
    assert not {'coefficients', 'lift_drag', 'convergence'} & {d.name for d in drawings(told)}
