"""A receiver that ranges tells how far each door is from the ship, as the model predicts."""

import math
from dataclasses import replace

import numpy as np
import pytest

from trawl_ros import InstrumentSuite, build_model, load_gear, load_instruments, steady_state
from trawl_ros.core.errors import InstrumentError
from trawl_ros.instruments.errors.instrument import SeedPlan
from trawl_ros.instruments.parameters import default_instruments_with
from trawl_ros.records.channels import MEASURED, channel_values, readings
from trawl_ros.records.partial_truth import partial_truth
from trawl_ros.records.surroundings import Surroundings

WATER = Surroundings(pressure_at=lambda depth: 101_325.0 + 10_052.0 * depth)


def test_slant_ranges_are_read_where_they_are_fitted():
    model = build_model(load_gear('kaifuha').refined(net=0.25))
    seen = steady_state(model, 500.0, 2.1).observables
    # A taut warp is straight and no longer than it was paid out, within its stretch.
    assert 0.9 * 500.0 < seen.port_slant_range < 502.0
    assert seen.port_slant_range == pytest.approx(seen.starboard_slant_range, rel=1e-6)
    aboard = {'door': {'slant_range': {'rate_hz': 0.5, 'noise_m': 1.0}}}
    fitted = default_instruments_with(aboard, 'own', InstrumentError, prefix='instruments')
    suite = InstrumentSuite(fitted, surroundings=WATER, draws=SeedPlan(seed=3))
    found = []
    for second in range(200):
        truth = replace(partial_truth(second * 1_000_000_000), observables=seen)
        for sample in suite.observe(truth):
            if sample.topic == 'door/port/slant_range':
                (reading,) = readings(sample, math.nan)
                assert reading.low <= reading.value <= reading.high
                found.append(channel_values(sample, math.nan)['port_slant_range'])
    assert len(found) == 100
    assert np.mean(found) == pytest.approx(seen.port_slant_range, abs=0.5)
    assert np.std(found) == pytest.approx(1.0, rel=0.3)
    assert 'port_slant_range' in MEASURED


def test_no_slant_range_is_aboard_by_default():
    assert load_instruments().door.slant_range is None
