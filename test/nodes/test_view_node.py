"""The running graph is recorded as it is seen; a slow viewer costs neither time nor memory."""

import numpy as np
import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')
pytest.importorskip('rerun', reason='needs the extra `view`: make test-view installs it')

from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.messages.to_messages import sample_message  # noqa: E402
from trawl_ros.nodes import view_node  # noqa: E402
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.nodes.view_node import ViewNode  # noqa: E402
from trawl_ros.plots.records import Quantities  # noqa: E402
from trawl_ros.records.samples import RangeSample, WinchSample  # noqa: E402
from trawl_ros.view import live  # noqa: E402
from trawl_ros.view.live import LiveView  # noqa: E402
from trawl_ros.view.reading import TOPICS  # noqa: E402
from trawl_ros.view.records import Innovations, Note  # noqa: E402

pytestmark = pytest.mark.ros


def recorded_to(path):
    return LiveView(TOPICS, 'headless', bind='127.0.0.1', port=None, memory_mb=200, output=path)


def lengths(path):
    """Stamps (ns) and values of the port warp's counter in a recording."""
    try:
        from rerun.chunk import RrdReader
    except ImportError:  # before 0.40
        from rerun.experimental import RrdReader
    found = {}
    for chunk in RrdReader(path).stream():
        if str(chunk.entity_path) == '/histories/warp_length/port_length/measured':
            batch = chunk.to_record_batch()
            if not chunk.is_static:
                times = batch.column('time').cast('int64').to_pylist()
                values = batch.column('Scalars:scalars').to_pylist()
                found.update(zip(times, (value[0] for value in values), strict=True))
    return found


def winch(second, length):
    return WinchSample(second * SECOND, (length, length), (0.0, 0.0), (1e5, 1e5))


def test_what_is_published_is_recorded_with_its_stamps(open_graph, tmp_path, monkeypatch):
    path = tmp_path / 'live.rrd'
    monkeypatch.setattr(view_node, 'open_view', lambda parameters, output: recorded_to(path))
    with open_graph() as graph:
        node = graph.add(ViewNode)
        ship = graph.add(lambda **kwargs: TrawlNode('ship', **kwargs))
        ship.advertise('winch/joint_states')
        graph.until(lambda: ship.subscribers()['winch/joint_states'][0] == 1)
        for second in range(20):
            ship.send(*sample_message(winch(second, 300.0 + second)))
            graph.until(lambda second=second: node._view.shown > second)
        graph.remove(node)
    assert lengths(path) == {second * SECOND: 300.0 + second for second in range(20)}


def test_a_tow_that_begins_anew_is_a_recording_of_its_own(tmp_path):
    view = recorded_to(tmp_path / 'live.rrd')
    for first in (1000, 0):
        for second in range(30):
            values = {'port_length': 300.0 + first}
            view.put(Quantities((first + second) * SECOND, 'measured', values))
    view.close()
    assert view.trouble == ''
    assert set(lengths(tmp_path / 'live.rrd').values()) == {1300.0}
    assert set(lengths(tmp_path / 'live_2.rrd').values()) == {300.0}


def test_estimates_that_lag_behind_the_readings_begin_no_tow(tmp_path):
    view = recorded_to(tmp_path / 'live.rrd')
    for second in range(30):
        view.put(Quantities((1000 + second) * SECOND, 'measured', {'port_length': 300.0}))
        view.put(Note(second * SECOND, 'estimator', 'INFO', 'a window of long ago'))
        view.put(Innovations(second * SECOND, {'door_spread': 1.0}))
    view.close()
    assert (view.trouble, view.shown) == ('', 90)
    assert len(lengths(tmp_path / 'live.rrd')) == 30
    assert not (tmp_path / 'live_2.rrd').exists()


def test_what_a_slow_viewer_does_not_take_is_given_up_and_counted(tmp_path, monkeypatch):
    monkeypatch.setattr(live, 'WAITING_RECORDS', 100)
    view = recorded_to(tmp_path / 'live.rrd')
    with view._lock:  # Held, the thread takes nothing.
        waiting = view._waiting
        waiting.extend(Quantities(k, 'measured', {}) for k in range(100))
    for _ in range(50):
        view.put(Quantities(100, 'measured', {}))
    assert view.waiting <= 100
    view.close()
    assert view.shown + view.lost == 150
    assert view.trouble == ''


def test_a_reading_that_is_none_is_not_drawn(tmp_path):
    view = recorded_to(tmp_path / 'live.rrd')
    view.put(Quantities(0, 'measured', {'port_length': np.nan}))
    view.close()
    assert lengths(tmp_path / 'live.rrd') == {}


def test_the_status_tells_what_was_given_up(open_graph, tmp_path, monkeypatch):
    monkeypatch.setattr(
        view_node, 'open_view', lambda parameters, output: recorded_to(tmp_path / 'l.rrd')
    )
    with open_graph() as graph:
        node = graph.add(ViewNode)
        node._view.lost = 3
        (status,) = node.statuses()
        assert '3 records' in status.message
        assert status.values['records given up'] == '3'
        spread = RangeSample(SECOND, 'spread', 80.0, 1.0, 1.0, 400.0)
        ship = graph.add(lambda **kwargs: TrawlNode('ship', **kwargs))
        topic, message = sample_message(spread)
        ship.advertise(topic)
        graph.until(lambda: ship.subscribers()[topic][0] == 1)
        ship.send(topic, message)
        graph.until(lambda: node._view.shown == 1)
