"""Over time: truth as lines, readings as dots, silence as bars, and what is missing in words."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.colors import to_hex

from trawl_ros.model.water import Water
from trawl_ros.plots.histories import PANELS, history_figure, left_out, silences
from trawl_ros.plots.reading import read_history
from trawl_ros.plots.records import Series
from trawl_ros.report import style


def panel(figure, label):
    (axes,) = (axes for axes in figure.axes if axes.texts and axes.texts[0].get_text() == label)
    return axes


def test_truth_is_a_thin_line_and_readings_are_dots(tow):
    axes = panel(history_figure(tow), 'door depth / m')
    dots = [line for line in axes.lines if line.get_linestyle() == 'None']
    lines = [line for line in axes.lines if line.get_linestyle() != 'None']
    assert [to_hex(line.get_color()) for line in dots] == [style.PORT, style.STARBOARD]
    assert dots[0].get_marker() != dots[1].get_marker()
    assert [line.get_linestyle() for line in lines] == ['-', '--']
    assert all(line.get_linewidth() <= 1.0 and line.get_marker() == 'None' for line in lines)
    assert axes.yaxis_inverted()
    minutes, depths = lines[0].get_data()
    assert (minutes[-1], depths[-1]) == pytest.approx((2.0, 72.0))


def test_every_panel_says_its_unit(tow):
    figure = history_figure(tow)
    assert len(figure.axes) == len(PANELS)
    assert all(' / ' in axes.texts[0].get_text() for axes in figure.axes)


def test_a_sensor_that_says_nothing_leaves_a_gap_and_a_bar(tow, known):
    series = tow.measured['starboard_door_depth']
    assert silences(series, tow.duration_s) == [known.SILENT]
    assert silences(tow.measured['port_door_depth'], tow.duration_s) == []
    (bar,) = panel(history_figure(tow), 'door depth / m').collections
    begin, end = bar.get_paths()[0].get_extents().intervalx
    assert (60.0 * begin, 60.0 * end) == pytest.approx(known.SILENT)
    assert to_hex(bar.get_facecolor()[0]) == style.STARBOARD


def test_nan_is_silence_and_so_is_an_early_end():
    times = np.arange(0.0, 100.0)
    values = np.where((times > 20.0) & (times < 50.0), np.nan, 1.0)
    assert silences(Series(times, values), 200.0) == [(20.0, 50.0), (99.0, 200.0)]
    assert silences(Series(times, np.full(100, np.nan)), 100.0) == [(0.0, 100.0)]


def test_outliers_are_marked_at_the_edge_and_hide_nothing(tow):
    spread = tow.measured['door_spread']
    values = spread.values.copy()
    values[[10, 60]] = [900.0, -500.0]
    wild = replace(tow, measured={**tow.measured, 'door_spread': Series(spread.times, values)})
    axes = panel(history_figure(wild), 'door spread / m')
    low, high = axes.get_ylim()
    assert 60.0 < low < 80.0 < high < 100.0
    edges = {line.get_marker(): line.get_data() for line in axes.lines}
    assert edges['^'][0] == pytest.approx(10.0 / 60.0)
    assert edges['^'][1] == pytest.approx(high)
    assert edges['v'][0] == pytest.approx(1.0)


def test_a_spike_of_truth_is_never_cut_off(tow):
    spread = tow.truth['door_spread']
    values = np.where(np.arange(len(spread.values)) == 50, 200.0, spread.values)
    steep = replace(tow, truth={**tow.truth, 'door_spread': Series(spread.times, values)})
    assert panel(history_figure(steep), 'door spread / m').get_ylim()[1] > 200.0


def test_truth_is_broken_where_it_was_not_recorded(tow):
    spread = tow.truth['door_spread']
    kept = (spread.times < 30.0) | (spread.times > 60.0)
    holed = replace(
        tow,
        truth={**tow.truth, 'door_spread': Series(spread.times[kept], spread.values[kept])},
    )
    axes = panel(history_figure(holed), 'door spread / m')
    (line,) = (line for line in axes.lines if line.get_linestyle() == '-')
    assert np.isnan(line.get_ydata()).sum() == 1


def test_headings_are_those_of_a_compass(tow):
    axes = panel(history_figure(tow), 'true heading / °')
    (line,) = (line for line in axes.lines if line.get_linestyle() == '-')
    degrees = line.get_ydata()
    # 165° by ENU is 285° on a compass, and turning to port lowers it.
    assert (degrees[0], degrees[-1]) == pytest.approx((285.0, 255.0), abs=1e-6)


def test_what_is_missing_is_said(tow, readings_only):
    assert left_out(tow) == []
    bare = read_history(readings_only, Water().depth, 'trawl')
    panels, truth = left_out(bare)
    assert panels.endswith(': opening.')
    assert 'no truth' in truth
    figure = history_figure(bare)
    assert len(figure.axes) == len(PANELS) - 1
    assert 'truth' not in [text.get_text() for text in figure.legends[0].get_texts()]
    partly = replace(
        tow,
        truth={name: series for name, series in tow.truth.items() if name != 'opening_width'},
        measured={name: series for name, series in tow.measured.items() if name != 'port_roll'},
    )
    measured, truth = left_out(partly)
    assert measured.endswith(': door roll (port).')
    assert truth.endswith(': opening (width).')
