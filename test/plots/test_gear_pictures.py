"""The gear is drawn where it is, from the best that the bag has."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.gear.load import load_gear
from trawl_ros.messages.cdr import deserialize
from trawl_ros.messages.markers import gear_markers
from trawl_ros.model.water import Water
from trawl_ros.plots.gear import extent, gear_figure
from trawl_ros.plots.moments import GEAR, MOUTH, Moment, read_moments
from trawl_ros.plots.reading import read_history
from trawl_ros.plots.records import SCHOOLS
from trawl_ros.plots.shapes import FROM_MARKERS, FROM_READINGS, FROM_TRUTH, gear_shape
from trawl_ros.records.topics import DOOR_FRAMES
from trawl_ros.records.truth import SchoolTruth


@pytest.fixture(scope='module')
def kaifuha():
    return load_gear('kaifuha')


def shape_at(path, time, kaifuha):
    tow = read_history(path, Water().depth, 'trawl')
    (moment,) = read_moments(path, tow, [time], 'trawl', [GEAR, MOUTH])
    return gear_shape(moment, tow, kaifuha)


def doors(shape):
    named = {strand.name: strand.pieces.reshape(-1, 3) for strand in shape.strands}
    return np.array([named[frame].mean(axis=0) for frame in DOOR_FRAMES.values()])


@pytest.mark.parametrize(
    ('parts', 'source'),
    [(('truth', 'markers'), FROM_MARKERS), (('truth',), FROM_TRUTH)],
)
def test_truth_puts_the_doors_behind_the_ship_whatever_her_heading(
    parts, source, known, kaifuha, tmp_path
):
    path = known.write(tmp_path / 'bag', parts)
    for time in (20.0, 100.0):
        shape = shape_at(path, time, kaifuha)
        assert shape.source == source
        assert shape.by_tension == (source == FROM_MARKERS)
        depth = known.DEPTH + known.SINKING * time
        expected = [[known.ASTERN, side * known.HALF_SPREAD, -depth] for side in (1.0, -1.0)]
        np.testing.assert_allclose(doors(shape), expected, atol=0.02)


def test_readings_alone_give_straight_warps_of_the_measured_length(readings_only, known, kaifuha):
    shape = shape_at(readings_only, 20.0, kaifuha)
    assert shape.source == FROM_READINGS
    depth = known.DEPTH + known.SINKING * 20.0
    np.testing.assert_allclose(doors(shape)[:, 1], [known.HALF_SPREAD, -known.HALF_SPREAD])
    np.testing.assert_allclose(doors(shape)[:, 2], -depth, atol=1e-3)
    for strand in shape.strands:
        if strand.name.endswith('_warp'):
            (block, door) = strand.pieces[0]
            assert np.linalg.norm(door - block) == pytest.approx(known.LENGTH, abs=1e-6)
    (mouth,) = (strand for strand in shape.strands if strand.name == 'mouth')
    assert mouth.pieces[..., 2].max() == pytest.approx(-known.NET_DEPTH, abs=1e-3)


def test_a_silent_door_is_not_drawn_from_old_readings(known, kaifuha, tmp_path, monkeypatch):
    monkeypatch.setattr('trawl_ros.plots.shapes.READING_AWAY_S', 10.0)
    path = known.write(tmp_path / 'bag', ['instruments'])
    shape = shape_at(path, sum(known.SILENT) / 2, kaifuha)
    names = {strand.name for strand in shape.strands}
    assert 'door_port' in names
    assert 'door_starboard' not in names


def test_too_little_gives_nothing(known, kaifuha, tmp_path):
    path = known.write(tmp_path / 'bag', ['sonar'])
    assert shape_at(path, 20.0, kaifuha) is None


def test_a_bag_logged_late_shows_the_same_moment(known, kaifuha, tmp_path):
    late = known.write(tmp_path / 'late', ('truth', 'markers'), log_lag_s=30.0)
    depth = known.DEPTH + known.SINKING * 100.0
    np.testing.assert_allclose(-doors(shape_at(late, 100.0, kaifuha))[:, 2], depth, atol=0.02)


def test_all_views_have_equal_scales(bag, kaifuha, tmp_path):
    figure = gear_figure(shape_at(bag, 60.0, kaifuha), 'tow')
    figure.savefig(tmp_path / 'gear.png')
    size = figure.get_size_inches()
    for axes in figure.axes[:2]:
        box = axes.get_position()
        metres = np.abs([np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim())])
        inches = np.array([box.width, box.height]) * size
        assert metres[0] / inches[0] == pytest.approx(metres[1] / inches[1], rel=1e-6)
    assert 'truth' in figure.get_suptitle()
    assert any('tension' in axes.get_xlabel() for axes in figure.axes)


def test_port_is_red_and_starboard_green(readings_only, kaifuha):
    shape = shape_at(readings_only, 20.0, kaifuha)
    colours = {strand.name: strand.colours[0] for strand in shape.strands}
    red, green, _ = colours['port_warp']
    assert red > green
    red, green, _ = colours['starboard_warp']
    assert green > red


def test_fish_are_drawn_where_they_are_and_do_not_widen_the_views(bag, known, kaifuha):
    tow = read_history(bag, Water().depth, 'trawl')
    (moment,) = read_moments(bag, tow, [60.0], 'trawl', [GEAR, MOUTH])
    without = extent([gear_shape(moment, tow, kaifuha)])
    truth = known.truth_at(60.0)
    heading = truth.vessel.heading
    behind = truth.vessel.position - 350.0 * np.array([np.cos(heading), np.sin(heading), 0.0])
    near = SchoolTruth(behind + [0.0, 0.0, -70.0], np.array([40.0, 20.0, 10.0]), 1.0)
    far = SchoolTruth(behind + [9e3, 0.0, -70.0], np.array([40.0, 20.0, 10.0]), 1.0)
    picture = replace(known.picture_of(truth), schools=(near, far))
    drawn = gear_markers(picture)[1]
    markers = deserialize(drawn.data, drawn.__msgtype__)
    shape = gear_shape(Moment(60.0, {GEAR: markers}), tow, kaifuha)
    fish = [strand.pieces.reshape(-1, 3) for strand in shape.strands if strand.name == SCHOOLS]
    np.testing.assert_allclose(fish[0].mean(axis=0), [350.0, 0.0, -70.0], atol=0.5)
    assert np.ptp(fish[0][:, 2]) == pytest.approx(10.0)
    np.testing.assert_allclose(extent([shape]), without, atol=1e-6)
