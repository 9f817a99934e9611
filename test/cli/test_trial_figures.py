"""What is drawn is what is in the bag."""

import numpy as np
import pytest

from trawl_ros.bags.reader import read_messages
from trawl_ros.cli.gear_figure import gear_figure
from trawl_ros.cli.trial_figures import history_figure, read_history
from trawl_ros.model.water import Water


@pytest.fixture
def bag(run, trial, tmp_path):
    assert run('tow', trial, '--out', tmp_path / 'bag').exit_code == 0
    return tmp_path / 'bag'


def test_measured_and_truth_lie_on_each_other(bag):
    history = read_history(bag, Water().depth)
    for measured, truth, tolerance in (
        ('door/spread', 'truth spread', 5.0),
        ('sonar/pressure', 'truth/net/opening', 2.0),
        ('door/port/pressure', 'truth door depth', 2.0),
        ('winch/joint_states length', 'truth/winch length', 2.0),
        ('winch/joint_states tension', 'truth/winch tension', 10e3),
    ):
        times, values = history.series[measured]
        true_times, true_values = history.series[truth]
        assert times[0] == true_times[0] == 0.0
        expected = np.interp(times, true_times, true_values)
        assert np.abs(values - expected).max() < tolerance, measured


def test_the_figures_have_their_panels(bag, tmp_path):
    history = read_history(bag, Water().depth)
    figure = history_figure(history)
    assert len(figure.axes) == 6
    assert all(axes.lines for axes in figure.axes)
    figure.savefig(tmp_path / 'history.png')
    assert (tmp_path / 'history.png').stat().st_size > 10_000


def test_the_gear_hangs_behind_the_ship_under_water(bag, tmp_path):
    (*_, last) = read_messages(bag, ['/trawl/truth/gear'])
    figure = gear_figure(last.message)
    top, side = figure.axes
    paths = [path for line in side.collections for path in line.get_paths()]
    points = np.concatenate([path.vertices for path in paths])
    assert points[:, 0].min() > -10.0
    assert 500.0 < points[:, 0].max() < 1500.0
    assert points[:, 1].max() < 1.0
    across = np.concatenate([p.vertices for line in top.collections for p in line.get_paths()])
    assert across[:, 1].max() == pytest.approx(-across[:, 1].min(), rel=0.05)
    figure.savefig(tmp_path / 'gear.png')


def test_without_a_picture_of_the_gear_the_axes_are_empty():
    assert not any(axes.collections for axes in gear_figure(None).axes)
