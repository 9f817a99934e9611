"""The vector that is estimated: groups, their places, and what is known of them before."""

import numpy as np
import pytest

from trawl_ros.core.errors import GearError
from trawl_ros.estimation.fit.error_terms import CALIBRATION, GROUPS, TERMS, model_errors
from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.estimation.fit.parameters import FARTHEST, ParameterGroup, ParameterVector
from trawl_ros.records.coefficients import COEFFICIENTS


@pytest.fixture
def stall():
    group = ParameterGroup('effect', ('stall onset', 'stall loss'), ('rad', ''))
    return ParameterVector(
        np.array([0.5, 0.0]), np.array([0.1, 0.2]), np.zeros(2), np.ones(2), (group,)
    )


@pytest.fixture
def drag():
    group = ParameterGroup('effect', ('drag area',), ('m²',))
    return ParameterVector(np.zeros(1), np.ones(1), -np.ones(1), np.ones(1), (group,))


@pytest.fixture
def joint(prior, stall, drag):
    return prior.followed_by(stall).followed_by(drag)


def test_groups_stand_one_behind_the_other(joint):
    assert len(joint) == 15
    assert joint.names == (*COEFFICIENTS, 'stall onset', 'stall loss', 'drag area')
    assert joint.units[12:] == ('rad', '', 'm²')
    assert joint.slice_of('coefficients') == slice(0, 12)
    assert joint.slice_of('effect') == slice(12, 15)
    assert joint.blocks('effect') == (range(12, 14), range(14, 15))
    assert joint.start[12] == 0.5


def test_a_kind_that_is_absent_has_no_place(prior):
    assert len(prior.std[prior.slice_of('effect')]) == 0
    assert prior.blocks('effect') == ()
    assert len(prior.only('effect')) == 0


def test_a_part_is_what_it_was_before_it_was_joined(joint, prior, stall, drag):
    effects = joint.only('effect')
    assert effects.groups == (*stall.groups, *drag.groups)
    np.testing.assert_array_equal(effects.std, [0.1, 0.2, 1.0])
    board = joint.only('coefficients')
    assert board.groups == prior.groups
    np.testing.assert_array_equal(board.start, prior.start)


def test_departures_count_in_prior_std(stall):
    np.testing.assert_allclose(stall.departure(np.array([0.7, -0.1])), [2.0, -0.5])


def test_a_step_stays_within_reach_and_bounds(stall):
    low, high = stall.box(np.array([0.5, 0.1]), 2.0)
    np.testing.assert_allclose(low, [0.3, 0.0])
    np.testing.assert_allclose(high, [0.7, 0.5])
    np.testing.assert_allclose(stall.clipped(np.array([-1.0, 2.0])), [0.0, 1.0])
    at_low, at_high = stall.on_bounds(np.array([0.0, 1.0]))
    assert at_low.tolist() == [True, False]
    assert at_high.tolist() == [False, True]


def test_values_go_by_their_names(joint):
    values = np.arange(15.0)
    assert joint.unpacked(values, 'effect') == {
        'stall onset': 12.0,
        'stall loss': 13.0,
        'drag area': 14.0,
    }
    assert joint.unpacked(values, 'coefficients') == dict(zip(COEFFICIENTS, range(12), strict=True))


def test_what_contradicts_itself_is_refused_by_name(stall):
    with pytest.raises(GearError, match='stall loss is 0'):
        ParameterVector(stall.start, stall.std, np.full(2, 0.4), stall.high, stall.groups)
    with pytest.raises(GearError, match='expected 2 finite numbers'):
        ParameterVector(stall.start, stall.std, stall.low, np.array([1.0]), stall.groups)
    with pytest.raises(ValueError, match='found 1 units, expected 2'):
        ParameterGroup('effect', ('onset', 'loss'), ('rad',))


def test_it_cannot_be_changed(stall):
    with pytest.raises(ValueError, match='read-only'):
        stall.start[0] = 0.0


@pytest.mark.parametrize(
    ('options', 'number', 'net'),
    [
        (EstimatorOptions(), len(GROUPS), slice(0, 0)),
        (EstimatorOptions(model_trend=1.0), 2 * len(GROUPS), slice(0, 0)),
        (EstimatorOptions(net_drag=0.2), len(GROUPS) + 2, slice(len(GROUPS), len(GROUPS) + 2)),
    ],
)
def test_errors_of_the_model_are_parameters_in_std(options, number, net):
    errors = model_errors(options)
    assert len(errors) == number
    assert errors.slice_of('net') == net
    np.testing.assert_array_equal(errors.clipped(np.full(number, 9.0)), FARTHEST)
    assert CALIBRATION.names == tuple(term.channel for term in TERMS)
