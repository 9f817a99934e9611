"""Transducers at the blocks report the angles of the warps that the model predicts."""

import math
from dataclasses import replace

import numpy as np
import pytest

from trawl_ros import InstrumentSuite, build_model, load_gear, load_instruments, steady_state
from trawl_ros.instruments.errors.instrument import SeedPlan
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.records.channels import MEASURED, channel_values
from trawl_ros.records.partial_truth import partial_truth
from trawl_ros.records.possible import impossible
from trawl_ros.records.samples import WarpAngleSample
from trawl_ros.records.surroundings import Surroundings

ANGLES = ('port_divergence', 'starboard_divergence', 'port_declination', 'starboard_declination')


@pytest.fixture(scope='module')
def towed():
    model = build_model(load_gear('kaifuha').refined(net=0.25))
    return steady_state(model, 500.0, 2.1).observables


def suite():
    surroundings = Surroundings(pressure_at=lambda depth: 101_325.0 + 10_052.0 * depth)
    return InstrumentSuite(load_instruments(), surroundings=surroundings, draws=SeedPlan(seed=3))


def read(instruments, observables, seconds):
    truths = (
        replace(partial_truth(n * 1_000_000_000), observables=observables) for n in range(seconds)
    )
    samples = [sample for truth in truths for sample in instruments.observe(truth)]
    return [sample for sample in samples if isinstance(sample, WarpAngleSample)]


def test_readings_scatter_about_what_the_model_predicts(towed):
    samples = read(suite(), towed, 200)
    values = [channel_values(sample, math.nan) for sample in samples]
    assert set(ANGLES) == {name for value in values for name in value} <= set(MEASURED)
    for name in ANGLES:
        read_off = np.array([value[name] for value in values if name in value])
        assert len(read_off) == 200
        assert np.degrees(read_off.std()) == pytest.approx(0.5, rel=0.2)
        assert np.degrees(abs(read_off.mean() - getattr(towed, name))) < 1.0


def test_the_message_has_divergence_and_declination_in_the_ship(towed):
    sample = read(suite(), towed, 1)[0]
    topic, message = sample_message(sample)
    assert topic == 'winch/port/warp_angles'
    assert (message.vector.x, message.vector.y) == (sample.divergence, sample.declination)
    assert message.header.frame_id == 'vessel'
    assert impossible(sample) is None
    assert impossible(replace(sample, declination=2.0))


def test_a_fault_sits_on_one_angle(towed):
    instruments = suite()
    instruments.panel.switch('winch/port/warp_angles/declination', 'offset 0.1')
    port, starboard = read(instruments, towed, 1)
    assert port.declination - towed.port_declination == pytest.approx(0.1, abs=0.03)
    assert starboard.declination == pytest.approx(towed.starboard_declination, abs=0.03)
