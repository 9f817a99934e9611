"""A tow is watched again with boards as they were learned, as if it had been from the beginning."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.diagnosis.onset.candidates import candidate_table
from trawl_ros.diagnosis.onset.gear import WatchedGear
from trawl_ros.diagnosis.onset.knowledge import Knowledge
from trawl_ros.diagnosis.onset.monitor import OnsetMonitor
from trawl_ros.diagnosis.onset.part import SETTLING
from trawl_ros.diagnosis.onset.residuals import belief_of
from trawl_ros.diagnosis.onset.watch import CLOSE, REST, Watch, WatchSettings, WatchStart
from trawl_ros.effects.effect_set import effects_of
from trawl_ros.effects.registry import catalogue
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.estimation.motion.towing.lineariser import NotPredicted, TowLineariser
from trawl_ros.gear.load import load_gear
from trawl_ros.model.gear_model import build_model
from trawl_ros.model.water import build_water

FEW = {'tension_cell': catalogue()['tension_cell']}


@pytest.fixture(scope='module')
def onset_gear(coarse_gear):
    return load_gear(coarse_gear)


@pytest.fixture
def far_off(onset_gear):
    """Boards a std off in all coefficients, as they are known."""
    std = 0.2 * board_prior(onset_gear).std
    wrong = onset_gear.board.coefficients.array() + std * np.resize([1.0, -1.0], len(std))
    return Knowledge(wrong, np.diag(std**2))


@pytest.fixture
def settings(onset_gear, far_off):
    table = candidate_table(FEW)
    gear = WatchedGear(build_model(onset_gear), effects_of(onset_gear), table.at_one_hour())
    return WatchSettings(gear, build_water(onset_gear), table, far_off, 20)


def watched(watch, samples):
    """Stretches as they are watched."""
    return [watch.advance() for sample in samples if watch.feed(sample)]


def test_boards_that_were_learned_are_closer_to_what_is_learned_with_them(
    settings, far_off, onset_samples
):
    first = Watch(settings, WatchStart(far_off.values, belief_of(far_off)))
    watched(first, onset_samples(9))
    assert first.away > CLOSE
    assert first.learns
    again = Watch(settings, WatchStart(first.learned, belief_of(far_off)))
    watched(again, onset_samples(9))
    assert again.away < 0.5 * first.away


def test_a_watch_that_begins_with_a_belief_goes_on_as_the_one_that_had_it(
    settings, far_off, onset_samples
):
    whole = Watch(settings, WatchStart(far_off.values, belief_of(far_off)))
    by_whole = watched(whole, onset_samples(9))
    first = 3
    begin_ns = whole.part.begin_ns(first)
    later = [sample for sample in onset_samples(9) if sample.stamp >= begin_ns]
    belief = whole.belief(first + SETTLING)
    part = Watch(settings, WatchStart(far_off.values, belief))
    by_part = [one for one in watched(part, later) if one.compared]
    assert len(by_part) > 3
    away = []
    for one, other in zip(by_part[::-1], by_whole[::-1], strict=False):
        assert one.end_ns == pytest.approx(other.end_ns, abs=2e9)
        away.append(one.innovations - other.innovations)
    # The model began in another equilibrium, and errors along the way are known for less long.
    assert np.sqrt(np.nanmean(np.square(away))) < 0.4


def test_boards_far_off_are_learned_within_minutes_and_the_tow_is_judged(
    onset_gear, far_off, onset_samples
):
    told = []
    monitor = OnsetMonitor(onset_gear, far_off, effects=FEW, on_stretch=told.append)
    assert not [one for sample in onset_samples(11) for one in monitor.feed(sample)]
    assert monitor.why_not == ''
    compared = [one for one in told if one.compared]
    learned = [one for one in compared if one.why_not]
    assert REST <= len(learned) <= 3 * REST
    assert np.nanmax([one.rarity for one in compared]) < 0.5 * monitor.options.limit


def test_boards_with_which_nothing_can_be_compared_for_minutes_are_refused(
    settings, far_off, onset_samples, monkeypatch
):
    def surfaced(*_):
        raise NotPredicted('the gear of the model breaks the surface')

    watch, told = Watch(settings, WatchStart(far_off.values, belief_of(far_off))), []
    monkeypatch.setattr(TowLineariser, '_predicted', surfaced)
    for sample in onset_samples(8):
        if watch.feed(sample):
            assert not watch.advance().compared
            told.append((watch.part.number, watch.refused))
    assert next(number for number, refused in told if refused) == SETTLING + REST
    assert watch.lost


def test_boards_known_by_the_gear_file_alone_are_learned_for_longer(
    onset_gear, far_off, onset_samples
):
    poorly = replace(far_off, covariance=far_off.covariance / 0.2**2)
    monitor = OnsetMonitor(onset_gear, poorly, effects=FEW)
    assert not [one for sample in onset_samples(9) for one in monitor.feed(sample)]
    assert monitor.watched == 0
    assert 'boards' in monitor.why_not
