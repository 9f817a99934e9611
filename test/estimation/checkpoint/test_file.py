"""A saved identification goes on as if nothing had happened, and a bad file is refused."""

import json
import os
import zipfile
from dataclasses import replace
from datetime import date
from pathlib import Path

import numpy as np
import pytest

from trawl_ros.estimation.checkpoint import file
from trawl_ros.estimation.checkpoint.file import CheckpointError, load_checkpoint, save_checkpoint
from trawl_ros.estimation.checkpoint.packing import Packer, Unpacker
from trawl_ros.estimation.from_gear import identification_for
from trawl_ros.estimation.pipeline import Identification, WindowUsed
from trawl_ros.estimation.windows.records import WindowOptions
from trawl_ros.gear.load import load_gear

OPTIONS = WindowOptions(settle_s=60.0, settle_passages=0.0, window_s=40.0)


def used(events):
    return [event for event in events if isinstance(event, WindowUsed)]


@pytest.fixture
def fresh(sea, model, prior):
    def make(**options):
        chosen = replace(OPTIONS, speed_tolerance=0.15, **options)
        return Identification(model, prior, sea.OBSERVABLES, sea.pressure_to_depth, chosen)

    return make


@pytest.fixture
def samples(sea, model):
    legs = [sea.Leg(length, speed, 130.0) for speed in (1.8, 2.1) for length in (300.0, 500.0)]
    return sea.tow(model, legs)


@pytest.fixture
def state(fresh, samples, gear, tmp_path):
    """A state saved in the middle of a tow, and who saved it."""
    identification = fresh()
    for sample in samples[: len(samples) // 2]:
        identification.feed(sample)
    assert identification.estimate.windows >= 2
    save_checkpoint(tmp_path / 'state', identification, gear)
    return tmp_path / 'state'


@pytest.mark.parametrize('every', [101, 1009])
def test_it_goes_on_with_the_same_estimates(fresh, samples, gear, tmp_path, every):
    """Saved and resumed again and again, in the middle of settling, windows and sweeps."""
    whole, torn = fresh(), fresh()
    windows = 0
    for number, sample in enumerate(samples):
        if number % every == every - 1 and number > len(samples) // 3:
            save_checkpoint(tmp_path / 'state', torn, gear)
            torn = load_checkpoint(tmp_path / 'state', fresh(), gear)
        expected, found = whole.feed(sample), torn.feed(sample)
        assert [type(event) for event in found] == [type(event) for event in expected]
        for one, other in zip(used(found), used(expected), strict=True):
            windows += 1
            assert one.window == other.window
            same(one.estimate, other.estimate)
    whole.finish()
    torn.finish()
    assert windows >= 4
    same(torn.estimate, whole.estimate)
    assert torn.rejected == whole.rejected
    assert torn.finder.arrived == whole.finder.arrived


def same(found, expected):
    np.testing.assert_allclose(found.values, expected.values, rtol=0, atol=1e-9)
    np.testing.assert_allclose(found.covariance, expected.covariance, rtol=0, atol=1e-9)
    assert (found.revision, found.windows) == (expected.revision, expected.windows)
    if expected.innovation is not None:
        np.testing.assert_allclose(found.innovation.values, expected.innovation.values, rtol=1e-9)


def test_the_solver_goes_on_from_the_same_shapes(steady_tow, coarse_gear, tmp_path):
    gear = load_gear(coarse_gear)

    def build():
        return identification_for(gear, window_options=OPTIONS)

    samples = list(steady_tow.samples(leg_s=130))
    whole, torn = build(), build()
    for number, sample in enumerate(samples):
        if number == len(samples) // 2:
            assert torn.estimate is not None
            save_checkpoint(tmp_path / 'state', torn, gear)
            torn = load_checkpoint(tmp_path / 'state', build(), gear)
        expected, found = used(whole.feed(sample)), used(torn.feed(sample))
        for one, other in zip(found, expected, strict=True):
            # Where factors are at hand the way to the same root is rounded otherwise.
            np.testing.assert_allclose(one.estimate.values, other.estimate.values, rtol=1e-9)
    assert {window.state for window in whole.estimator.windows} == {0, 1}
    whole.finish()
    torn.finish()
    of_std = np.outer(whole.estimate.std, whole.estimate.std)
    np.testing.assert_allclose(
        torn.estimate.covariance / of_std, whole.estimate.covariance / of_std, atol=1e-9
    )


def test_one_that_was_resumed_can_be_reset(fresh, samples, state, gear):
    resumed = load_checkpoint(state, fresh(), gear)
    resumed.reset()
    assert resumed.estimate is None
    assert not resumed.rejected
    anew = fresh()
    for sample in samples:
        for one, other in zip(used(resumed.feed(sample)), used(anew.feed(sample)), strict=True):
            same(one.estimate, other.estimate)
    assert resumed.finder.rejected == anew.finder.rejected


def test_objects_that_share_something_share_it_afterwards(fresh, state, gear):
    finder = load_checkpoint(state, fresh(), gear).finder
    before = dict(finder.rejected)
    buffer = finder._buffers['door_spread']
    buffer._rejections.counts['outlier'] += 1
    assert finder.rejected['outlier'] == before.get('outlier', 0) + 1


def test_of_another_gear_or_other_settings_is_refused_by_name(fresh, state, gear):
    other = gear.model_copy(update={'netting': gear.netting.model_copy(update={'around': 24})})
    with pytest.raises(CheckpointError, match=r'gear\.netting\.around \d+, expected 24'):
        load_checkpoint(state, fresh(), other)
    with pytest.raises(CheckpointError, match=r'windows\.settle_s 60\.0, expected 90\.0'):
        load_checkpoint(state, fresh(settle_s=90.0), gear)


@pytest.mark.parametrize(('name', 'value'), [('FORMAT', 2), ('__version__', '9.9')])
def test_of_another_version_is_refused(fresh, state, gear, monkeypatch, name, value):
    monkeypatch.setattr(file, name, value)
    with pytest.raises(CheckpointError, match=f'expected format .*{value}'):
        load_checkpoint(state, fresh(), gear)


def test_what_is_no_state_is_refused(fresh, gear, tmp_path):
    path = tmp_path / 'state'
    with pytest.raises(CheckpointError, match='no such file'):
        load_checkpoint(path, fresh(), gear)
    for content in (b'', b'{}', b'PK\x03\x04 and no more'):
        path.write_bytes(content)
        with pytest.raises(CheckpointError, match='no undamaged state'):
            load_checkpoint(path, fresh(), gear)


def test_a_pipe_or_device_in_the_place_of_a_state_is_refused_at_once(fresh, gear, tmp_path):
    os.mkfifo(tmp_path / 'pipe')
    for path in (tmp_path / 'pipe', Path('/dev/zero')):
        with pytest.raises(CheckpointError, match='expected a file'):
            load_checkpoint(path, fresh(), gear)


def test_a_damaged_file_is_refused_wherever_the_damage_is(fresh, state, gear):
    whole = state.read_bytes()
    expected = load_checkpoint(state, fresh(), gear).estimate
    refused = 0
    places = np.random.default_rng(0).integers(len(whole), size=60)
    headers = [*range(0, 60, 4), *range(len(whole) - 160, len(whole), 4)]
    for place in (*places, *headers):
        damaged = bytearray(whole)
        damaged[place] ^= 0x55
        state.write_bytes(damaged)
        try:
            found = load_checkpoint(state, fresh(), gear)
        except CheckpointError:
            refused += 1
        else:
            # Dates and flags of the archive's entries are read by nobody.
            same(found.estimate, expected)
    assert refused > 50
    for share in (0.0, 0.3, 0.99):
        state.write_bytes(whole[: int(share * len(whole))])
        with pytest.raises(CheckpointError):
            load_checkpoint(state, fresh(), gear)


def rewritten(state, change):
    """The same file with something changed, checksums and all."""
    with zipfile.ZipFile(state) as archive:
        record = json.loads(archive.read(file.JSON))
        numbers = archive.read(file.NUMBERS)
    change(record)
    with zipfile.ZipFile(state, 'w') as archive:
        archive.writestr(file.JSON, json.dumps(record))
        archive.writestr(file.NUMBERS, numbers)


def test_a_file_builds_no_other_classes_and_takes_no_more_memory_than_it_is_long(
    fresh, state, gear
):
    def other_class(record):
        record['identification']['object'] = 'subprocess.Popen'

    def imported_class(record):
        record['identification']['object'] = 'trawl_ros.estimation.checkpoint.file.Packer'

    def other_attributes(record):
        record['identification']['has']['surprise'] = 1

    def huge(record):
        record['identification'] = {'number': 0, 'array': '<f8', 'shape': [10**12], 'at': 0}

    def unknown(record):
        record['identification'] = {'number': 0, 'same': 7}

    whole = state.read_bytes()
    for change in (other_class, imported_class, other_attributes, huge, unknown):
        state.write_bytes(whole)
        rewritten(state, change)
        with pytest.raises(CheckpointError, match='of this version'):
            load_checkpoint(state, fresh(), gear)


def test_a_state_larger_than_allowed_is_neither_read_nor_written(fresh, state, gear, monkeypatch):
    resumed = load_checkpoint(state, fresh(), gear)
    before = state.read_bytes()
    monkeypatch.setattr(file, 'MAX_BYTES', 1000)
    with pytest.raises(CheckpointError, match='expected at most'):
        load_checkpoint(state, fresh(), gear)
    with pytest.raises(CheckpointError, match='are not saved'):
        save_checkpoint(state, resumed, gear)
    assert state.read_bytes() == before


def test_a_failed_write_leaves_the_state_before_it(fresh, state, gear, monkeypatch):
    resumed = load_checkpoint(state, fresh(), gear)
    before = state.read_bytes()

    def full(descriptor):
        raise OSError(28, 'No space left on device')

    monkeypatch.setattr(file.os, 'fsync', full)
    with pytest.raises(CheckpointError, match='No space left'):
        save_checkpoint(state, resumed, gear)
    assert state.read_bytes() == before
    with pytest.raises(CheckpointError, match='cannot be written'):
        save_checkpoint(state.parent / 'nowhere' / 'state', resumed, gear)


def test_what_is_no_data_is_named():
    with pytest.raises(TypeError, match=r'when\.1 is a datetime'):
        Packer(None).pack({'when': [1.0, date(2026, 1, 1)]})


@pytest.mark.parametrize(
    'value',
    [
        float('nan'), float('-inf'), 0.1 + 0.2, np.float64(1e-300), {1: (2.0, None)}, 'name', True,
        np.arange(6.0).reshape(2, 3).T, np.zeros((0, 12)), np.array(3), np.array([True, False]),
    ],
)  # fmt: skip
def test_values_come_back_bit_by_bit(value):
    packer = Packer(None)
    tree = json.loads(json.dumps(packer.pack(value)))
    found = Unpacker(bytes(packer.numbers), packer).unpack(tree)
    np.testing.assert_equal(found, value)
