"""Search of a fit in motion: steps that lose stretches of the tows."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.estimation.least_squares.descent import DescentOptions, descend
from trawl_ros.estimation.motion.fit_records import MotionOptions
from trawl_ros.estimation.motion.nuisances import layout_of
from trawl_ros.estimation.motion.search import PREDICTIONS_TO_FIND_ERRORS, MotionSearch, without
from trawl_ros.estimation.motion.towing.towed_gear import TowedGear
from trawl_ros.lab.benchmark.motion import course_tow
from trawl_ros.records.coefficients import COEFFICIENTS


def test_a_search_is_spent_by_its_predictions(coarse, gear):
    search = search_from(coarse, gear)
    search.begin()
    assert not search.is_spent
    search.towings = search.options.towings
    assert search.is_spent


def test_a_step_on_which_boards_fall_is_given_up_as_soon_as_it_is_refused(coarse, gear):
    far = search_from(coarse, gear, b5=-3.0)
    whole = far.linearise(far.here, 1)
    assert list(whole[0].towed) == [True, False, False, False]
    seen = []
    far.on_stretch = lambda iteration, tow, stretch: seen.append(stretch)
    with pytest.raises(NoSteadyState, match=r'20 s after .* board'):
        far.linearise(far.here, 1, before=[np.ones(4, bool)])
    assert seen == [0]
    assert far.towings == 2
    kept = far.linearise(far.here, 1, before=[whole[0].towed])
    np.testing.assert_array_equal(kept[0].values, whole[0].values)


def test_a_tow_is_without_what_another_leaves_out_for_its_reasons(coarse, gear):
    fallen, usual = search_from(coarse, gear, b5=-3.0), search_from(coarse, gear)
    there, here = fallen.linearise(fallen.here, 0), usual.linearise(usual.here, 0)
    (less,) = without(here, there)
    assert list(less.towed) == [True, False, False, False]
    assert less.left_out == there[0].left_out
    np.testing.assert_array_equal(less.values[0], here[0].values[0])
    assert without(there, here)[0].left_out == there[0].left_out
    assert without(here, here)[0].towed.all()


def test_stretches_that_are_lost_late_stay_lost(coarse, gear):
    truth = search_from(coarse, gear, b5=-1.5)
    (towed,) = truth.linearise(truth.here, 0)
    assert towed.towed.all()
    kept = {}
    for regain in (True, False):
        search = search_from(coarse, gear, b5=-3.0)
        search.tows = [replace(search.tows[0], means=towed.values)]
        search.begin()
        assert list(search.linear[0].towed) == [True, False, False, False]
        search.found = 0 if regain else PREDICTIONS_TO_FIND_ERRORS
        descend(search, DescentOptions(iterations=2, attempts=4, tolerance=0.0))
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


def test_equilibria_that_were_found_are_where_the_next_towing_starts(coarse, gear):
    search = search_from(coarse, gear)
    tow = search.tows[0]
    search.tows = [replace(tow, held_s=np.full(len(tow), 600.0)).only_steady()]
    search.begin()
    assert search.gear.near
    inputs = tow.inputs.values[-1]
    (nearest,) = search.gear.nearest(inputs)
    away = [abs(known.point.port_length - inputs[0]) for known in search.gear.near]
    assert abs(nearest.point.port_length - inputs[0]) == min(away)
    again = search.linearise(search.here, 1)
    np.testing.assert_allclose(again[0].values, search.linear[0].values, rtol=1e-6)
