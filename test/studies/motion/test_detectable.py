"""Smallest detectable sizes in motion: what they count, and what becomes of them in a report."""

from dataclasses import replace

import numpy as np
import pytest

from studies.harness import Work, run_study
from studies.motion.detectable import DetectableSizes, detectable_rows
from studies.motion.detectable_information import ExaminedGear, information_in_motion
from studies.motion.study import STUDY, MotionPlan
from trawl_ros.diagnosis.inference.candidates import Candidate
from trawl_ros.diagnosis.onset.candidates import WATCHED
from trawl_ros.effects.effect_set import NO_EFFECTS
from trawl_ros.effects.registry import catalogue
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.lab.benchmark.motion import course_tow
from trawl_ros.model.gear_model import build_model

EXAMINED = ('warp_strumming', 'tension_cell', 'bottom_contact')


@pytest.fixture(scope='module')
def examined(gear):
    """A coarse gear with three effects to be found, one on the ground at 120 m."""
    netting = gear.netting.model_copy(update={'around': 12})
    model = build_model(gear.model_copy(update={'netting': netting}))
    wanted = [Candidate(catalogue()[name], catalogue()[name].neutral) for name in EXAMINED]
    wanted[2] = Candidate(catalogue()['bottom_contact'], np.array([0.0, 120.0]))
    return ExaminedGear(model, NO_EFFECTS, model.coefficients, board_prior(gear), tuple(wanted))


def short_tow():
    """Eighty seconds of hauling, without the opening, which no fit in motion uses."""
    tow = course_tow(80.0)
    used = [place for place, name in enumerate(tow.channels) if name in WATCHED]
    parts = {name: getattr(tow, name)[:, used] for name in ('means', 'noise', 'counts', 'weights')}
    return replace(tow, channels=tuple(tow.channels[place] for place in used), **parts)


def test_more_tows_show_more_and_what_changes_nothing_is_never_seen(examined):
    tow = short_tow()
    once, twice = (information_in_motion(examined, [tow] * number) for number in (1, 2))
    assert twice.counted_s == 2.0 * once.counted_s == 160.0
    strumming, offset, scale, friction, depth = once.evidence.std(range(5))
    assert np.all(np.isfinite([strumming, offset, scale, friction]))
    # Where there is no friction it is all the same how deep the ground is.
    assert np.isinf(depth)
    more = twice.evidence.std(range(4))
    assert np.all(more < [strumming, offset, scale, friction])
    # Calibration is drawn anew in each tow, and the gear stays the same.
    assert np.all(more > np.array([strumming, offset, scale, friction]) / 2.0)
    assert twice.added_mass.std([0]) < once.added_mass.std([0]) < np.inf


def found(**changes):
    rows = {
        'series': 'detectable', 'number': 0, 'effects': ['a', 'b', 'b', 'c', 'd'],
        'values': ['x', 'y', 'z', 'x', 'x'], 'units': ['', 'm', 'm', '', ''],
        'windows': [0.6, 4.0, 8.0, 1.0, None], 'motion': [0.12, 1.0, 8.0, 0.9, None],
        'added_mass': 0.3, 'number_of_windows': 20, 'counted_s': 12_000.0, 'cpu_s': 200.0,
    }  # fmt: skip
    return DetectableSizes(**(rows | changes))


def test_the_median_is_over_effects_and_those_that_nothing_shows_are_told():
    median, of_values, *rows = detectable_rows(found())
    assert median.value == pytest.approx(0.5)
    assert median.ok
    assert 'neither shows d' in median.note
    # Of 0.2, 0.25, 1 and 0.9.
    assert of_values.value == pytest.approx(0.575)
    assert [row.value for row in rows] == pytest.approx([0.2, 0.5, 0.9])
    assert 'y (m) 4, 1; z (m) 8, 8' in rows[1].note
    worse, *_ = detectable_rows(found(motion=[0.12, 4.0, 8.0, 0.9, None]))
    assert worse.value == pytest.approx(0.9)
    assert not worse.ok


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_four_tows_are_towed_and_what_they_show_is_kept(tmp_path):
    plan = MotionPlan(trials=0, around=12, detectable=True)
    rows = run_study(STUDY, plan, Work(tmp_path))
    assert 0.0 < rows[0].value < 1.0
    assert len(rows) > 30
    assert run_study(STUDY, plan, Work(tmp_path)) == rows
