"""The film has the frames it was given, ends when told to, and is never long."""

from dataclasses import replace

import pytest
from PIL import Image

from trawl_ros.gear.load import load_gear
from trawl_ros.plots.film import MOST_FRAMES, Frame, frame_times, write_film
from trawl_ros.plots.moments import GEAR, read_moments, read_sweeps
from trawl_ros.plots.shapes import gear_shape


@pytest.fixture(scope='module')
def frames(bag, tow):
    gear = load_gear('kaifuha')
    times = [10.0, 60.0, 110.0]
    pictures, _ = read_sweeps(bag, tow, times, 'trawl')
    moments = read_moments(bag, tow, times, 'trawl', [GEAR])
    return [
        Frame(gear_shape(moment, tow, gear), picture)
        for moment, picture in zip(moments, pictures, strict=True)
    ]


def test_each_frame_differs_from_the_one_before(frames, tmp_path):
    path = tmp_path / 'film.gif'
    assert write_film(path, 'tow', frames, lambda _: True) == 3
    with Image.open(path) as film:
        assert film.n_frames == 3
        assert film.size[0] < 900
        shown = []
        for number in range(3):
            film.seek(number)
            shown.append(film.convert('RGB').tobytes())
    assert len(set(shown)) == 3


def test_it_ends_early_when_told_to(frames, tmp_path):
    path = tmp_path / 'film.gif'
    assert write_film(path, 'tow', frames, lambda done: done < 2) == 2
    with Image.open(path) as film:
        assert film.n_frames == 2


def test_without_a_sonar_the_net_is_seen_from_behind(frames, tmp_path):
    bare = [replace(frame, picture=None) for frame in frames[:1]]
    assert write_film(tmp_path / 'film.gif', 'tow', bare, lambda _: True) == 1


def test_however_long_the_tow_the_frames_are_few(tow):
    assert len(frame_times(replace(tow, duration_s=1e6))) == MOST_FRAMES
    assert frame_times(replace(tow, duration_s=0.0)) == [0.0]
    assert frame_times(tow)[-1] == tow.duration_s
