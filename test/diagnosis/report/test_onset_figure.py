"""The figure of a watched tow shows when something began, and when that was told."""

import numpy as np
import pytest

from trawl_ros.core.time import SECOND
from trawl_ros.diagnosis.onset.candidates import WATCHED
from trawl_ros.diagnosis.onset.findings import Finding
from trawl_ros.diagnosis.onset.history import WatchedCourse
from trawl_ros.diagnosis.report.onset_figure import onset_figure

MINUTE = 60 * SECOND


def test_the_channels_that_changed_are_named_and_the_finding_is_marked_at_its_minute():
    ends = np.arange(1, 41) * MINUTE // 2
    innovations = np.zeros((40, len(WATCHED)))
    changed = WATCHED.index('net_depth')
    innovations[21:, changed] = 5.0
    course = WatchedCourse(ends, innovations, np.linspace(0.0, 20.0, 40))
    found = Finding(
        1, 'raised', 12 * MINUTE, 12 * MINUTE, 10 * MINUTE, 9 * MINUTE, 11 * MINUTE,
        'kite', 'It is lost', {}, (), 11.0, 9.0,
    )  # fmt: skip
    figure = onset_figure(course, [found], 9.0, 0)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert 'net depth' in labels
    above, below = figure.axes
    marked = [line.get_xdata()[0] for line in above.lines if len(set(line.get_xdata())) == 1]
    assert sorted(marked) == pytest.approx([10.0, 12.0])
    assert any('found 2.0 min' in text.get_text() for text in below.texts)


def test_a_tow_without_a_finding_has_its_figure_too():
    course = WatchedCourse(np.array([MINUTE]), np.full((1, len(WATCHED)), 0.3), np.array([1.0]))
    assert len(onset_figure(course, [], 9.0, 0).axes) == 2
