"""What identification_node and discrepancy_node publish is shown, from their first window on."""

import runpy
from pathlib import Path

import numpy as np
import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')
pytest.importorskip('rerun', reason='needs the extra `view`: make test-view installs it')

from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.nodes import view_node  # noqa: E402
from trawl_ros.nodes.bag_player import BagPlayer  # noqa: E402
from trawl_ros.nodes.discrepancy_node import DiscrepancyNode  # noqa: E402
from trawl_ros.nodes.identification_node import IdentificationNode  # noqa: E402
from trawl_ros.nodes.view_node import ViewNode  # noqa: E402
from trawl_ros.records.coefficients import COEFFICIENTS  # noqa: E402
from trawl_ros.view.live import LiveView  # noqa: E402
from trawl_ros.view.reading import TOPICS  # noqa: E402

pytestmark = [pytest.mark.ros, pytest.mark.slow]

Recording = runpy.run_path(str(Path(__file__).parents[1] / 'view' / 'conftest.py'))['Recording']


STEADY = {'settle_s': 10.0, 'settle_passages': 0.0, 'window_s': 20.0}


def recorded_to(path):
    return LiveView(TOPICS, 'headless', bind='127.0.0.1', port=None, memory_mb=200, output=path)


@pytest.fixture(scope='module')
def shown(open_graph, tight_tows, coarse_gear, estimate_listener, tmp_path_factory):
    """The recording of the view, and what the nodes know at the end."""
    folder = tmp_path_factory.mktemp('shown')
    gear = str(coarse_gear)
    with pytest.MonkeyPatch.context() as patch, open_graph() as graph:
        patch.setattr(
            view_node, 'open_view', lambda parameters, output: recorded_to(folder / 'live.rrd')
        )
        viewer = graph.add(ViewNode, gear=gear)
        estimator = graph.add(IdentificationNode, gear=gear, **STEADY)
        watcher = graph.add(
            DiscrepancyNode, gear=gear, output=str(folder / 'report'), baseline_tows=1, **STEADY
        )
        listener = graph.add(estimate_listener)
        player = graph.add(
            BagPlayer, bag=str(tight_tows.path), rate=0.0,
            wait_for=['identification_node', 'discrepancy_node'],
        )  # fmt: skip
        graph.until(lambda: player.exit_code is not None, timeout_s=120.0)
        graph.remove(player)
        graph.until(lambda: estimator._worker.idle and watcher._watching.idle, timeout_s=120.0)
        graph.settle()
        values = listener.status['coefficients'].values
        graph.remove(viewer)
        return Recording(folder / 'live.rrd'), values


def test_estimates_are_shown_as_the_node_has_them_and_narrow(shown, tight_tows):
    recording, values = shown
    narrowed = 0
    for name in COEFFICIENTS:
        stamps, estimates = recording.series(f'/estimate/{name}/value')
        _, low = recording.series(f'/estimate/{name}/low')
        _, high = recording.series(f'/estimate/{name}/high')
        assert len(stamps) > tight_tows.tows
        assert (np.diff(stamps) > 0).all()
        assert (low < estimates).all()
        assert (estimates < high).all()
        narrowed += high[-1] - low[-1] < high[0] - low[0]
        assert estimates[-1] == pytest.approx(float(values[name]), rel=1e-5)
        assert low[-1] == pytest.approx(float(values[f'{name} low']), rel=1e-4)
    # Cells that show too much widen some of them.
    assert narrowed >= len(COEFFICIENTS) / 2


def test_innovations_come_with_every_window(shown, tight_tows):
    recording, _ = shown
    channels = {path for path in recording.entities if path.startswith('/innovations/')}
    assert {'/innovations/door_spread', '/innovations/port_tension'} <= channels
    stamps, deviations = recording.series('/innovations/port_tension')
    second_tow = stamps > (1000 + tight_tows.apart_s - 1) * SECOND
    # Cells that show an eighth too much are far from what the first tow lets expect.
    assert np.abs(deviations[second_tow][0]) > 2.0 * np.abs(deviations[~second_tow]).mean()


def test_the_finding_is_told_at_its_time(shown, tight_tows):
    recording, _ = shown
    told = [
        (stamp, row['text'][0])
        for path in recording.entities
        if path.startswith('/notes/')
        for stamp, row in recording.rows(path)
    ]
    stamps = [stamp for stamp, text in told if 'tension cell' in text]
    assert stamps, told
    assert min(stamps) > (1000 + tight_tows.apart_s) * SECOND
