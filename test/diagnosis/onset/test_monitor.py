"""A tow that goes on is watched: what begins in it is found within minutes."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.core.time import SECOND
from trawl_ros.diagnosis.onset.candidates import WATCHED
from trawl_ros.diagnosis.onset.knowledge import Knowledge, of_gear_file
from trawl_ros.diagnosis.onset.monitor import NOT_CLOSE, OnsetMonitor, OnsetOptions
from trawl_ros.diagnosis.onset.part import LIVE, SETTLING
from trawl_ros.diagnosis.onset.watch import JUST_BEGUN, LEARNS, REST
from trawl_ros.effects.registry import catalogue
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.estimation.motion.towing.lineariser import BY_SENSOR
from trawl_ros.gear.load import load_gear
from trawl_ros.messages.diagnostics import WARN
from trawl_ros.nodes.workers.finding_status import onset_watch_status
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.records.samples import AttitudeSample, WinchSample

BEGIN_S = 540.0
FEW = {name: catalogue()[name] for name in ('tension_cell', 'net_drag', 'catch_build_up')}


@pytest.fixture(scope='module')
def onset_gear(coarse_gear):
    return load_gear(coarse_gear)


@pytest.fixture
def monitor(onset_gear):
    std = board_prior(onset_gear).std
    known = Knowledge(onset_gear.board.coefficients.array(), np.diag((0.2 * std) ** 2))
    return OnsetMonitor(onset_gear, known, effects=FEW)


def test_cells_that_begin_to_show_too_much_are_found_with_time_and_size(monitor, onset_samples):
    findings = [found for sample in onset_samples(12, BEGIN_S) for found in monitor.feed(sample)]
    first, last = findings[0], findings[-1]
    assert first.delay_s < 300.0
    begin_ns = BEGIN_S * SECOND
    assert abs(first.onset_ns - begin_ns) < 90.0 * SECOND
    assert first.onset_low_ns <= begin_ns <= first.onset_high_ns
    assert 'tension_cell' in (last.name, *last.alike) or last.name == 'both_tension_offset'
    assert {found.number for found in findings} == {1}
    dismissed = monitor.dismiss(1)
    assert dismissed is not None
    assert dismissed.state == 'dismissed'
    assert monitor.dismiss(1) is None
    more = onset_samples(15, BEGIN_S)
    again = [one for sample in more if sample.stamp > 720 * SECOND for one in monitor.feed(sample)]
    assert not again, 'what was dismissed is not raised anew'


def test_evidence_by_boards_that_are_not_close_is_confirmed_by_those_as_learned_before_it_is_raised(
    monitor, onset_samples, monkeypatch
):
    told, findings = [], []
    for sample in onset_samples(14, BEGIN_S):
        if sample.stamp > BEGIN_S * SECOND:
            # From here on no boards are close.
            monkeypatch.setattr('trawl_ros.diagnosis.onset.monitor.CLOSE', 0.0)
        findings += monitor.feed(sample)
        told.append((bool(findings), onset_watch_status(monitor, '')))
    withheld = {status.level for _, status in told if status.message == NOT_CLOSE}
    assert withheld == {WARN}
    assert not [status for found, status in told if found and status.message == NOT_CLOSE]
    assert abs(findings[0].onset_ns - BEGIN_S * SECOND) < 90.0 * SECOND


@pytest.mark.slow
def test_a_gap_is_told_and_the_tow_is_watched_again_behind_it(monitor, onset_samples):
    silent = (480.0, 600.0)
    reasons = set()
    for sample in onset_samples(23):
        if not silent[0] < sample.stamp / SECOND < silent[1]:
            assert monitor.feed(sample) == []
            reasons.add(monitor.why_not)
    assert any('silent' in reason for reason in reasons)
    assert monitor.why_not == ''
    assert monitor.watched > 5


@pytest.mark.slow
def test_a_long_tow_is_watched_on_with_its_last_stretches(onset_gear, onset_samples):
    std = board_prior(onset_gear).std
    known = Knowledge(onset_gear.board.coefficients.array(), np.diag((0.2 * std) ** 2))
    told, options = [], OnsetOptions(longest=18, again=6)
    monitor = OnsetMonitor(onset_gear, known, options, effects=FEW, on_stretch=told.append)
    assert [found for sample in onset_samples(16) for found in monitor.feed(sample)] == []
    assert len(monitor.watch) < len(told) - 2
    first = next(place for place, one in enumerate(told) if not one.why_not)
    assert len([one for one in told[first:] if one.why_not]) <= 2 * REST


def test_a_gear_that_the_model_cannot_tow_is_told(monitor, onset_samples):
    for sample in onset_samples(8):
        short = isinstance(sample, WinchSample)
        assert monitor.feed(replace(sample, lengths=(20.0, 20.0)) if short else sample) == []
    assert monitor.watched == 0
    assert monitor.why_not


def test_where_the_model_cannot_be_towed_other_boards_that_are_as_likely_are_tried(
    onset_gear, onset_samples
):
    prior, told = board_prior(onset_gear), []
    values = prior.start.copy()
    values[COEFFICIENTS.index('c4')] += 0.55 * prior.std[COEFFICIENTS.index('c4')]
    known = Knowledge(values, np.diag((0.4 * prior.std) ** 2))
    monitor = OnsetMonitor(onset_gear, known, effects=FEW, on_stretch=told.append)
    assert [found for sample in onset_samples(14) for found in monitor.feed(sample)] == []
    refused = [one for one in told if one.why_not.startswith('the model cannot be towed')]
    assert len(refused) == 1
    ends = [one.end_ns for one in told]
    assert sorted(set(ends)) == ends, 'a stretch counts once, however many boards are tried'
    assert monitor.watched > 3
    assert monitor.why_not == ''


def test_after_a_fall_the_model_begins_again_and_boards_have_to_be_close_once_more(
    monitor, onset_samples
):
    told = []
    monitor._on_stretch = told.append
    for sample in onset_samples(20):
        lies = isinstance(sample, AttitudeSample) and sample.side == 'port'
        falls = lies and 540.0 < sample.stamp / SECOND < 565.0
        assert monitor.feed(replace(sample, roll=2.6) if falls else sample) == []
    reasons = [one.why_not for one in told]
    fell = reasons.index(BY_SENSOR)
    assert '' in reasons[:fell]
    behind = reasons[fell + 1 :]
    assert behind[:SETTLING] == [JUST_BEGUN] * SETTLING
    assert behind[SETTLING : SETTLING + REST] == [LEARNS] * REST
    assert set(behind[SETTLING + REST :]) == {''}


def test_while_boards_are_far_from_what_is_learned_nothing_is_raised_and_that_is_told(
    onset_gear, onset_samples
):
    told, judged = [], []
    known = replace(of_gear_file(onset_gear), densities={'port_roll': 3.0 * LIVE.stretch_s**0.5})
    monitor = OnsetMonitor(
        onset_gear,
        known,
        effects=FEW,
        on_stretch=lambda one: (told if one.why_not else judged).append(one),
    )
    # Cells that begin to show too much meanwhile are learned with the boards.
    found = [one for sample in onset_samples(9, 350.0) for one in monitor.feed(sample)]
    assert found == []
    learning = [one for one in told if one.why_not == LEARNS]
    assert len(learning) >= REST
    assert np.isnan([one.rarity for one in learning]).all()
    assert monitor.unwatched == len(told)
    assert monitor.watched == len(judged)
    # What is known of errors is still known where the watch began anew with other boards.
    compared = [one for one in (*told, *judged) if one.compared]
    roll = WATCHED.index('port_roll')
    assert max(abs(one.innovations[roll]) for one in compared) < 0.1
