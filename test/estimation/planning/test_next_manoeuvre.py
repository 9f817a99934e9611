"""The next manoeuvre is the one that tells most per minute, and tells what it promises."""

import re
from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.estimation.fit.fit import AS_STATED, Fit
from trawl_ros.estimation.fit.linearised import linearise
from trawl_ros.estimation.from_gear import board_prior, estimator_options
from trawl_ros.estimation.planning.information import (
    covariance_from,
    information_in,
    information_of,
)
from trawl_ros.estimation.planning.next_manoeuvre import Adviser
from trawl_ros.estimation.planning.proposals import knowledge_of
from trawl_ros.estimation.planning.search import shortfall
from trawl_ros.estimation.planning.states import Explorer, Limits, Manoeuvre
from trawl_ros.estimation.planning.windows import expected_windows, imagined_windows
from trawl_ros.gear.load import load_gear
from trawl_ros.model.gear_model import build_model
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.predict import Predictor

FEW = Limits(lengths=(200.0,), speeds=(2.1, 2.5), shorter=(5.0,))
DONE = Manoeuvre(300.0, 300.0, 2.5)


@pytest.fixture(scope='module')
def record(coarse_gear):
    return load_gear(coarse_gear)


@pytest.fixture(scope='module')
def predictor(record):
    return Predictor(build_model(record))


@pytest.fixture(scope='module')
def fit(record, predictor) -> Fit:
    """Two windows of one state in each of two tows, with errors that make the loss work."""
    prior = board_prior(record)
    found = Explorer(predictor, prior.start).look_up(DONE, [])
    draw = np.random.default_rng(4).normal
    parts = []
    for tow in range(2):
        for part in imagined_windows(found, prior.start, state=tow, number=2, tow=tow):
            std = [part.window.std(name) for name in part.channels]
            measured = part.measured + draw(size=len(std)) * std
            window = replace(part.window, index=len(parts))
            parts.append(replace(part, window=window, measured=measured))
    return Fit(tuple(parts), np.array(prior.start), AS_STATED, prior, EstimatorOptions())


@pytest.fixture(scope='module')
def adviser(record, predictor, fit) -> Adviser:
    adviser = Adviser(record, predictor, FEW)
    while adviser.look_up(fit.coefficients):
        pass
    return adviser


def test_the_promise_is_what_the_fit_gives_when_the_windows_come(adviser, fit, predictor):
    advice = adviser.advise(fit)
    assert advice is not None
    found = adviser.known[advice.manoeuvre]
    come = []
    for part in expected_windows(fit, found, 2):
        solved = linearise(
            predictor, OBSERVABLES, part.window, fit.coefficients, (found.part.state,)
        )
        come.append(solved)
    after = replace(fit, windows=(*fit.windows, *come))
    fall = np.linalg.slogdet(fit.posterior.covariance)[1]
    fall -= np.linalg.slogdet(after.posterior.covariance)[1]
    assert advice.nats == pytest.approx(0.5 * fall, rel=1e-9)
    assert advice.nats > 0.0


def test_no_other_manoeuvre_tells_more_per_minute(adviser, fit):
    advice = adviser.advise(fit)
    best = (shortfall(advice.before) - shortfall(advice.after)) / advice.minutes
    assert best > 0.0
    for one in adviser.known:
        other = adviser._promise(fit, one, adviser.known)
        gain = shortfall(other.before) - shortfall(other.after)
        assert gain / other.minutes <= best * (1.0 + 1e-3)


@pytest.mark.parametrize('net', [False, True])
def test_what_ranks_manoeuvres_is_what_the_fit_knows(fit, net):
    fit = replace(fit, options=estimator_options(net=net))
    ours = covariance_from(information_in(fit), fit.prior)
    size = np.sqrt(np.outer(np.diag(ours), np.diag(ours)))
    assert np.max(np.abs(ours - fit.posterior.covariance) / size) < 1e-8


def test_adding_to_a_fit_is_adding_information(adviser, fit):
    found = adviser.known[Manoeuvre(200.0, 200.0, 2.5)]
    parts = expected_windows(fit, found, 2)
    taught = information_of(parts, fit.prior, fit.options, fit.scales)
    ours = covariance_from(information_in(fit) + taught, fit.prior)
    fits = replace(fit, windows=(*fit.windows, *parts)).posterior.covariance
    # Windows that agree with the fit change its weights a little, since its calibration moves.
    assert np.sqrt(np.diag(ours)) == pytest.approx(np.sqrt(np.diag(fits)), rel=0.05)


def without(fit, channel):
    """The fit whose windows have no reading of channels of this name."""
    deaf = []
    for part in fit.windows:
        window = part.window
        kept = [row for row, name in enumerate(part.channels) if channel not in name]
        deaf.append(
            replace(
                part,
                window=replace(
                    window,
                    means={n: v for n, v in window.means.items() if channel not in n},
                    noise={n: v for n, v in window.noise.items() if channel not in n},
                ),
                channels=tuple(part.channels[row] for row in kept),
                measured=part.measured[kept],
                values=part.values[kept],
                by_coefficients=part.by_coefficients[kept],
                by_inputs=part.by_inputs[kept],
                by_net=part.by_net[kept],
                slow=part.slow[kept],
            )
        )
    return replace(fit, windows=tuple(deaf))


def test_what_is_not_heard_promises_nothing(adviser, fit):
    candidate = next(iter(adviser.known.values()))
    for part in expected_windows(without(fit, 'pitch'), candidate, 2):
        assert not [name for name in part.channels if 'pitch' in name]


def test_it_advises_with_what_is_known_by_then(record, predictor, fit):
    adviser = Adviser(record, predictor, FEW)
    assert adviser.advise(fit) is None
    assert adviser.look_up(fit.coefficients)
    advice = adviser.advise(fit)
    assert advice.manoeuvre == Manoeuvre(200.0, 200.0, 2.5)
    assert advice.looked_up == adviser.looked_up == pytest.approx(1 / 4)
    assert str(advice).startswith('200 m at 2.5 m/s, ')
    assert 'well known' in str(advice)
    nothing = replace(fit, windows=())
    assert adviser.advise(nothing) is None


def test_manoeuvres_are_looked_up_anew_when_the_estimate_has_moved_far(record, predictor, fit):
    adviser = Adviser(record, predictor, replace(FEW, lengths=(200.0,), speeds=(2.5,), shorter=()))
    assert adviser.look_up(fit.coefficients)
    assert not adviser.look_up(fit.coefficients + 0.5 * fit.prior.std)
    there = fit.coefficients.copy()
    there[0] -= 1.1 * fit.prior.std[0]
    assert adviser.look_up(there)
    (candidate,) = adviser.known.values()
    assert np.array_equal(candidate.part.at, there)


@pytest.fixture(scope='module')
def untowable(fit):
    """Coefficients by which boards collapse: flow turns them to where they lift too little."""
    return moved(fit, c6=3.0)


def moved(fit, **away):
    """Coefficients away, in std of the prior, from those of the fit."""
    there = fit.coefficients.copy()
    for name, std in away.items():
        place = COEFFICIENTS.index(name)
        there[place] += std * fit.prior.std[place]
    return there


def test_an_estimate_that_could_not_tow_the_gear_leaves_the_advice_of_an_earlier_one(
    record, predictor, fit, untowable
):
    limits = Limits(lengths=(200.0, 500.0), speeds=(2.1, 2.3), shorter=())
    adviser = Adviser(record, predictor, limits)
    while adviser.look_up(fit.coefficients):
        pass
    before = dict(adviser.known)
    assert len(before) == 4
    assert adviser.trouble == ''
    wrong = replace(fit, coefficients=untowable)
    while adviser.look_up(wrong.coefficients):
        pass
    assert re.search(r'none of 4 .*\(collapsed 4\); the 4 ', adviser.trouble)
    assert adviser.known == before
    advice = adviser.advise(wrong)
    assert advice.windows == len(wrong.windows)
    assert {ranked.manoeuvre for ranked in advice.ranking} == set(before)
    # As soon as an estimate tows the gear again, what it finds counts alone.
    assert adviser.look_up(fit.coefficients)
    assert adviser.trouble == ''
    assert len(adviser.known) == 1


def test_an_estimate_that_could_not_tow_the_gear_where_it_is_is_not_believed(
    record, predictor, fit, untowable
):
    limits = Limits(lengths=(200.0, 500.0), speeds=(1.9,), shorter=())
    adviser, here = Adviser(record, predictor, limits), Manoeuvre(499.3, 500.2, 2.12)
    assert adviser.look_up(fit.coefficients, here)
    before = dict(adviser.known)
    # What is left to look up is looked up as it was believed before.
    assert adviser.look_up(untowable, here)
    assert not adviser.look_up(untowable, here)
    assert set(adviser.known) == {*before, Manoeuvre(200.0, 200.0, 1.9)}
    for known in adviser.known.values():
        assert np.array_equal(known.part.at, fit.coefficients)
    assert re.search(r'500 m at 2\.1 m/s \(collapsed\); the 1 ', adviser.trouble)
    assert adviser.advise(replace(fit, coefficients=untowable)).ranking
    assert not adviser.look_up(fit.coefficients, here)
    assert adviser.trouble == ''


def test_a_first_estimate_that_could_not_tow_the_gear_is_told(record, predictor, untowable):
    adviser = Adviser(record, predictor, Limits(lengths=(500.0,), speeds=(2.1,), shorter=()))
    assert adviser.trouble == ''
    assert adviser.look_up(untowable)
    assert re.search(r'none of 1 .*\(collapsed 1\)$', adviser.trouble)


def test_what_an_earlier_estimate_towed_faster_says_nothing_of_slower_ones(record, predictor, fit):
    limits = Limits(lengths=(200.0,), speeds=(1.9, 2.3, 2.5), shorter=())
    adviser = Adviser(record, predictor, limits)
    while adviser.look_up(fit.coefficients):
        pass
    assert len(adviser.known) == 3
    # Boards that flow lifts so much come out of the water, but not at the least speed.
    while adviser.look_up(moved(fit, c3=-16.0)):
        pass
    assert set(adviser.known) == {Manoeuvre(200.0, 200.0, 1.9)}


def test_manoeuvres_near_to_the_ship_are_looked_up_first(record, predictor, fit):
    limits = Limits(lengths=(200.0, 300.0, 500.0), speeds=(2.1, 2.3), shorter=(5.0,))
    adviser = Adviser(record, predictor, limits)
    assert adviser.look_up(fit.coefficients, Manoeuvre(495.2, 499.7, 2.28))
    assert list(adviser.known) == [Manoeuvre(495.0, 500.0, 2.3)]


def test_the_ranking_has_all_that_is_known_but_the_state_that_goes_on(adviser, fit):
    ranking = adviser.advise(fit).ranking
    assert {ranked.manoeuvre for ranked in ranking} == set(adviser.known)
    assert [ranked.rate for ranked in ranking] == sorted((r.rate for r in ranking), reverse=True)
    assert adviser.advise(fit).windows == len(fit.windows)
    for ranked in ranking:
        seen = adviser.known[ranked.manoeuvre].part.state.observables
        assert ranked.tension == max(seen.port_tension, seen.starboard_tension)
        assert seen.net_depth < ranked.deepest < 2.0 * ranked.manoeuvre.length
        assert ranked.nats > 0.0
    there = expected_windows(fit, adviser.known[ranking[0].manoeuvre], 1)
    arrived = replace(fit, windows=(*fit.windows, *there))
    left = {ranked.manoeuvre for ranked in adviser.advise(arrived).ranking}
    assert left == set(adviser.known) - {ranking[0].manoeuvre}


def test_what_the_trial_hears_is_what_the_adviser_says(adviser, fit):
    advice = adviser.advise(fit)
    knowledge = knowledge_of(advice, 5)
    assert knowledge.windows == 5
    assert knowledge.advised == len(fit.windows)
    assert knowledge.known(0.2) == advice.before.well_known.sum()
    first = knowledge.proposals[0]
    assert first.target.port == advice.manoeuvre.port_length
    assert first.minutes == advice.minutes
    assert first.nats == pytest.approx(advice.nats, rel=0.1)
    assert knowledge_of(None, 2).proposals == ()


def test_a_newest_window_without_the_depth_of_the_net_is_advised_on(adviser, fit):
    assert adviser.advise(without(fit, 'net_depth')).minutes > 5.0
