"""Search of a fit in motion: where it begins, and which steps of the tows are halved there."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.estimation.motion.fit import fit_motion
from trawl_ros.estimation.motion.fit_records import MotionOptions
from trawl_ros.estimation.motion.nuisances import layout_of
from trawl_ros.estimation.motion.search import USUAL, MotionSearch, without
from trawl_ros.estimation.motion.towing import towed_stretch
from trawl_ros.estimation.motion.towing.inputs import INPUT_ERRORS
from trawl_ros.estimation.motion.towing.lineariser import linearise_tow
from trawl_ros.estimation.motion.towing.towed_gear import TowedGear, TowedPoint
from trawl_ros.lab.benchmark.motion import course_tow
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.solver.motion import stepper


@pytest.mark.parametrize(('coefficient', 'away'), [('a6', -3.0), ('b5', -6.0), ('c6', 3.0)])
def test_a_fit_begins_nearer_to_what_is_known_where_boards_fall(coarse, gear, coefficient, away):
    search = search_from(coarse, gear, **{coefficient: away})
    search.begin()
    assert search.linear[0].towed.all()
    nearer = search.here[0] / away
    assert nearer.max() in {0.5, 0.25, 0.125}
    assert np.count_nonzero(nearer) == 1
    assert search.towings == 1 - np.log2(nearer.max())


def test_a_fit_begins_nearer_only_as_long_as_that_is_of_use(coarse, gear):
    far = search_from(coarse, gear, a2=-2.0)
    far.begin()
    assert list(far.linear[0].towed) == [True, True, True, False]
    assert far.here[0].min() == -2.0
    assert far.towings == 2
    usual = search_from(coarse, gear, b5=0.1)
    usual.begin()
    assert usual.towings == 1


def test_what_boards_at_sea_fell_along_makes_no_fit_begin_nearer(coarse, gear):
    search = search_from(coarse, gear, b5=0.1)
    search.tows = [replace(search.tows[0], fallen=(1,))]
    search.begin()
    assert list(search.linear[0].towed) == [True, False, False, False]
    assert search.towings == 1


def test_a_search_is_spent_by_its_towings_or_by_what_they_cost(coarse, gear, monkeypatch):
    search = search_from(coarse, gear)
    search.begin()
    least = search.tows[0].steps * len(search.tows[0])
    assert least <= search.factorisations < USUAL * least
    assert not search.is_spent
    search.towings = search.options.towings
    assert search.is_spent
    search.towings = 1
    search.options = replace(search.options, towings=4)
    monkeypatch.setattr(stepper, 'DEPARTURE_M', 1e-6)
    search.linearise(search.here, 1)
    assert not search.is_spent
    search.linearise(search.here, 1)
    assert search.towings == 3
    assert search.is_spent


def test_a_step_on_which_boards_fall_is_given_up_as_soon_as_it_is_refused(coarse, gear):
    far = search_from(coarse, gear, b5=-3.0)
    whole, _ = far.linearise(far.here, 1)
    assert list(whole[0].towed) == [True, False, False, False]
    spent = far.factorisations
    with pytest.raises(NoSteadyState, match=r'20 s after .* board'):
        far.linearise(far.here, 1, before=[np.ones(4, bool)])
    assert 0 < far.factorisations - spent < spent
    assert far.towings == 2
    kept, _ = far.linearise(far.here, 1, before=[whole[0].towed])
    np.testing.assert_array_equal(kept[0].values, whole[0].values)


def test_a_tow_is_without_what_another_leaves_out_for_its_reasons(coarse, gear):
    fallen, usual = search_from(coarse, gear, b5=-3.0), search_from(coarse, gear)
    there, here = fallen.linearise(fallen.here, 0)[0], usual.linearise(usual.here, 0)[0]
    (less,) = without(here, there)
    assert list(less.towed) == [True, False, False, False]
    assert less.left_out == there[0].left_out
    np.testing.assert_array_equal(less.values[0], here[0].values[0])
    assert without(there, here)[0].left_out == there[0].left_out
    assert without(here, here)[0].towed.all()


def test_a_fit_begins_again_where_boards_all_but_fall(coarse, gear):
    truth = search_from(coarse, gear, a2=-1.0)
    (towed,), _ = truth.linearise(truth.here, 0)
    assert list(towed.towed) == [True, True, True, False]
    tow, begun = replace(truth.tows[0], means=towed.values), []
    fit = fit_motion(
        truth.gear, [tow], truth.prior, replace(truth.options, towings=6), truth.here,
        lambda iteration, number, stretch: begun.append(iteration),
    )  # fmt: skip
    assert fit.converged
    assert fit.parameters[0][COEFFICIENTS.index('a2')] < -0.75
    assert 0 < np.sum(fit.linear[0].towed) < 4
    # From nearer to what is known, where the boards stand, it did not come to rest.
    assert begun.index(1) < len(begun) - 1 - begun[::-1].index(0)


def test_stretches_that_are_lost_late_stay_lost(coarse, gear):
    truth = search_from(coarse, gear, b5=-1.5)
    (towed,), _ = truth.linearise(truth.here, 0)
    assert towed.towed.all()
    kept = {}
    for regain in (True, False):
        search = search_from(coarse, gear, b5=-3.0)
        search.tows = [replace(search.tows[0], means=towed.values)]
        search.begin(nearer=False)
        sizes = search.find(search.options.sizes)
        assert list(search.linear[0].towed) == [True, False, False, False]
        assert search.advance(sizes, 1, 4, regain=regain)
        assert search.advance(sizes, 2, 4, regain=regain)
        kept[regain] = search.linear[0]
    assert kept[True].towed.all()
    assert list(kept[False].towed) == [True, False, False, False]
    # What is lost is told, though it could be towed along there.
    assert {part.begin for part in kept[False].left_out} == {20.0, 40.0, 60.0}


def search_from(coarse, gear, **away):
    """Search on a short tow from coefficients away, in prior std, from those in the gear file."""
    tow, prior, towed = swift_haul(), board_prior(gear), TowedGear(coarse)
    layout = layout_of(tow, towed, 1.0)
    place = np.zeros(len(layout))
    for name, own in away.items():
        place[COEFFICIENTS.index(name)] = own
    return MotionSearch(
        towed, [tow], (layout,), prior, MotionOptions(), lambda *numbers: None, [place]
    )


def swift_haul():
    """The first 80 s of the course, hauled twice as fast, so that some boards fall at its end."""
    tow = course_tow(80.0)
    values = 2.0 * tow.inputs.values - tow.inputs.values[0]
    return replace(tow, inputs=replace(tow.inputs, values=values, rates=2.0 * tow.inputs.rates))


def test_boards_that_are_tossed_about_are_left_out_and_told(coarse, monkeypatch):
    tow, errors = course_tow(80.0), np.zeros(len(INPUT_ERRORS))
    point = TowedPoint(coarse.coefficients, 0.0, errors, np.zeros(0))
    usual = linearise_tow(TowedGear(coarse), tow, point)
    assert usual.towed.all()
    monkeypatch.setattr(stepper, 'DEPARTURE_M', 0.002)
    monkeypatch.setattr(towed_stretch, 'TOSSED', 2)
    there = linearise_tow(TowedGear(coarse), tow, point)
    # Boards that rest, as at the beginning, depart nowhere.
    assert list(there.towed) == [True, False, False, False]
    assert 'tossed about' in there.left_out[0].why


def test_a_search_halves_the_steps_that_failed_where_it_is(coarse, gear, monkeypatch):
    monkeypatch.setattr(stepper, 'DEPARTURE_M', 0.002)
    search = search_from(coarse, gear)
    search.begin()
    failed = {begin: set(steps) for begin, steps in search.halved[0].items()}
    assert failed[0.0]
    monkeypatch.setattr(stepper, 'DEPARTURE_M', 10.0)
    near, halved = search.linearise(search.here, 1, search.halved)
    assert halved[0] == failed
    np.testing.assert_allclose(near[0].values, search.linear[0].values, rtol=1e-9)
    afresh, none = search.linearise(search.here, 1)
    assert not none[0][0.0]
    assert np.abs(afresh[0].values / near[0].values - 1.0).max() > 1e-6
