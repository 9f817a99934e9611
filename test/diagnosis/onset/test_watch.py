"""A tow is watched again with boards as they were learned, as if it had been from the beginning."""

from dataclasses import replace
from functools import reduce

import numpy as np
import pytest

from trawl_ros.diagnosis.onset import towing
from trawl_ros.diagnosis.onset.candidates import candidate_table
from trawl_ros.diagnosis.onset.knowledge import Knowledge
from trawl_ros.diagnosis.onset.monitor import OnsetMonitor
from trawl_ros.diagnosis.onset.stretches import StretchCutter
from trawl_ros.diagnosis.onset.towing import WatchedGear
from trawl_ros.diagnosis.onset.watch import CLOSE, LEARNS, REST, Watch, WatchSettings
from trawl_ros.effects.effect_set import effects_of
from trawl_ros.effects.registry import catalogue
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.gear.load import load_gear
from trawl_ros.model.gear_model import build_model
from trawl_ros.model.water import build_water

FEW = {'tension_cell': catalogue()['tension_cell']}


@pytest.fixture(scope='module')
def onset_gear(coarse_gear):
    return load_gear(coarse_gear)


@pytest.fixture
def cut(onset_gear, onset_samples):
    def stretches(minutes):
        cutter = StretchCutter(build_water(onset_gear).depth)
        return [one for sample in onset_samples(minutes) for one in cutter.feed(sample)]

    return stretches


@pytest.fixture
def stretches(cut):
    return cut(9)


@pytest.fixture
def far_off(onset_gear):
    """Boards a std off in all coefficients, as they are known."""
    std = 0.2 * board_prior(onset_gear).std
    wrong = onset_gear.board.coefficients.array() + std * np.resize([1.0, -1.0], len(std))
    return Knowledge(wrong, np.diag(std**2))


@pytest.fixture
def settings(onset_gear):
    table = candidate_table(FEW)
    gear = WatchedGear(build_model(onset_gear), effects_of(onset_gear), table.at_one_hour())
    return WatchSettings(gear, table, 20, 1.2)


def test_boards_that_were_learned_are_closer_to_what_is_learned_with_them(
    settings, far_off, stretches
):
    first = Watch(settings, far_off, far_off.values)
    for last in stretches:
        first.advance(last)
    assert first.away > CLOSE
    assert first.learns
    again = Watch(settings, far_off, first.learned)
    for last in stretches:
        again.advance(last)
    assert again.away < 0.5 * first.away


def test_a_watch_that_begins_in_a_state_goes_on_as_the_one_that_was_in_it(
    settings, far_off, stretches
):
    whole = Watch(settings, far_off, far_off.values)
    seen = []
    for last in stretches:
        state = whole.state
        seen.append((last, state, whole.advance(last)))
    compared = [one for one in seen if one[2].white is not None]
    _, begin, _ = compared[2]
    part = Watch(settings, far_off, far_off.values, begin)
    for last, _, by_whole in compared[2:]:
        by_part = part.advance(last)
        # The model began at rest with another stretch.
        np.testing.assert_allclose(
            by_part.white.whitened(by_part.white.residual),
            by_whole.white.whitened(by_whole.white.residual),
            atol=0.3,
        )  # fmt: skip


def test_boards_far_off_are_learned_within_minutes_and_the_tow_is_judged(
    onset_gear, far_off, onset_samples
):
    told = []
    monitor = OnsetMonitor(onset_gear, far_off, effects=FEW, on_stretch=told.append)
    assert not [one for sample in onset_samples(11) for one in monitor.feed(sample)]
    assert monitor.why_not == ''
    compared = [one for one in told if one.white is not None]
    learned = [one for one in compared if one.why_not]
    assert REST <= len(learned) <= 3 * REST
    assert max(one.rarity for one in compared) < 0.5 * monitor.options.limit


@pytest.mark.parametrize(('compared', 'falls', 'minutes'), [(2, 1, 15), (REST + 1, 3, 20)])
def test_boards_that_were_close_before_a_fall_have_to_be_so_once_more(
    settings, onset_gear, cut, with_fall, compared, falls, minutes
):
    prior = board_prior(onset_gear)
    right = Knowledge(onset_gear.board.coefficients.array(), np.diag((0.2 * prior.std) ** 2))

    def watched(stretches):
        """Whether boards were learned still in each stretch; None where nothing was compared."""
        watch = Watch(settings, right, right.values)
        seen = [watch.advance(last) for last in stretches]
        assert watch.away < CLOSE
        return [None if one.white is None else one.why_not == LEARNS for one in seen]

    stretches = cut(minutes)
    first = next(number for number, last in enumerate(stretches) if last.tow is not None) + 1
    # While they are learned one fall is enough; later it takes one that the model is begun behind.
    fell = reduce(with_fall, range(first + compared, first + compared + falls), stretches)
    found = watched(fell)
    learned = min(compared, REST)
    assert found[first : first + compared] == [True] * learned + [False] * (compared - learned)
    behind = [one for one in found[first + compared :] if one is not None]
    assert behind == [True] * REST + [False] * (len(behind) - REST)
    assert len(behind) > REST


def test_boards_with_which_nothing_can_be_compared_for_minutes_are_refused_but_not_once_judged(
    settings, onset_gear, cut, monkeypatch
):
    std = 0.2 * board_prior(onset_gear).std
    right = Knowledge(onset_gear.board.coefficients.array(), np.diag(std**2))
    first, judged = (Watch(settings, right, right.values) for _ in range(2))
    stretches = cut(13)
    begun = next(number for number, last in enumerate(stretches) if last.tow is not None) + 1
    seen = [judged.advance(last) for last in stretches[: begun + REST + 1]]
    assert not seen[-1].why_not
    surfaced = 'the gear of the model breaks the surface'
    monkeypatch.setattr(towing.ModelTow, '_towed', lambda *_: surfaced)
    for last in stretches[begun + REST + 1 :]:
        assert judged.advance(last).why_not == surfaced
        assert not judged.refused
    told = []
    for last in stretches[: begun + REST + 1]:
        first.advance(last)
        told.append(first.refused)
    assert told == [False] * (begun + REST - 1) + [True, True]


def test_boards_known_by_the_gear_file_alone_are_learned_for_longer(
    onset_gear, far_off, onset_samples
):
    poorly = replace(far_off, covariance=far_off.covariance / 0.2**2)
    monitor = OnsetMonitor(onset_gear, poorly, effects=FEW)
    assert not [one for sample in onset_samples(9) for one in monitor.feed(sample)]
    assert monitor.watched == 0
    assert 'boards' in monitor.why_not
