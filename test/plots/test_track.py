"""The ship's track, and the current between heading and course."""

import re
from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.model.water import Water
from trawl_ros.plots.reading import read_history
from trawl_ros.plots.track import current, fixes_on_map, track_figure


def test_fixes_lie_on_the_true_track(tow):
    times, east, north = fixes_on_map(tow)
    for values, name in ((east, 'east'), (north, 'north')):
        expected = np.interp(times, tow.truth[name].times, tow.truth[name].values)
        np.testing.assert_allclose(values, expected, atol=0.05)


@pytest.mark.parametrize('without', ['measured', 'truth'])
def test_the_current_is_what_heading_and_log_do_not_explain(without, tow, known):
    east, north = current(replace(tow, **{without: {}}))
    known_at = np.isfinite(east.values)
    assert known_at.sum() > 100
    np.testing.assert_allclose(east.values[known_at], known.CURRENT[0], atol=1e-3)
    np.testing.assert_allclose(north.values[known_at], 0.0, atol=1e-3)


def test_the_figure_names_the_current(tow, tmp_path):
    figure = track_figure(tow)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels[:4] == ['fixes', 'truth', 'start', 'end']
    assert any(re.search(r'^current.* 0\.40 m/s .*090°$', label) for label in labels)
    figure.savefig(tmp_path / 'track.png')


def test_fixes_alone_start_at_the_origin(readings_only):
    tow = read_history(readings_only, Water().depth, 'trawl')
    _, east, north = fixes_on_map(tow)
    assert (east[0], north[0]) == (0.0, 0.0)
    assert track_figure(tow) is not None


def test_without_positions_there_is_no_track(tow):
    assert track_figure(replace(tow, truth={}, measured={})) is None
    assert current(replace(tow, truth={}, measured={})) is None
