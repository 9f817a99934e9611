"""Drifts of instruments: a line in time, of one side, of both, or of counters and log."""

import numpy as np

from trawl_ros.diagnosis.library.drift import drifts
from trawl_ros.effects.base.effect import Situation
from trawl_ros.effects.registry import catalogue
from trawl_ros.records.channels import MEASURED
from trawl_ros.records.observables import OBSERVABLES

BY_NAME = {own.name: own for own in drifts()}
LATE = Situation((500.0, 500.0, 2.0), hours=1.5)
TRUE = dict.fromkeys(OBSERVABLES, 100.0)


def test_every_measured_channel_may_drift_alone():
    alone = {own.channels[0] for own in BY_NAME.values() if len(own.channels) == 1}
    assert alone == set(MEASURED)


def test_names_are_no_others():
    assert not set(BY_NAME) & set(catalogue())


def test_a_drift_grows_from_what_it_begins_with():
    shown = BY_NAME['door_spread_drift'].apply_to_sensors(np.array([3.0, -1.0]), TRUE, LATE)
    assert shown == TRUE | {'door_spread': 103.5}


def test_both_sides_drift_together():
    shown = BY_NAME['both_pitch_drift'].apply_to_sensors(np.array([0.1, 0.0]), TRUE, LATE)
    assert {name for name in TRUE if shown[name] != TRUE[name]} == {'port_pitch', 'starboard_pitch'}


def test_counters_that_show_too_much_leave_less_warp_out():
    inputs = np.array(LATE.inputs)
    true = BY_NAME['counters_drift'].apply_to_inputs(np.array([10.0, 2.0]), inputs, LATE)
    np.testing.assert_allclose(true, [483.0, 483.0, 2.0])
