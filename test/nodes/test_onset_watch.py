"""`discrepancy_node` watches a tow without pause, and its log book has who was told what."""

import json
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np
import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from trawl_ros.diagnosis.onset.log_book import LogBook  # noqa: E402
from trawl_ros.estimation.from_gear import board_prior  # noqa: E402
from trawl_ros.gear.load import load_gear  # noqa: E402
from trawl_ros.messages.diagnostics import WARN, read_statuses  # noqa: E402
from trawl_ros.nodes.bag_player import BagPlayer  # noqa: E402
from trawl_ros.nodes.discrepancy_node import (  # noqa: E402
    ACKNOWLEDGE,
    DISMISS,
    FINDINGS,
    DiscrepancyNode,
)
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.nodes.runtime.qos import CONSUMER  # noqa: E402
from trawl_ros.records.coefficients import COEFFICIENTS  # noqa: E402

pytestmark = pytest.mark.ros

BEGIN_S = 540.0


class Bridge(TrawlNode):
    """Hears findings."""

    SPECS = ()

    def __init__(self, **kwargs):
        super().__init__('bridge', **kwargs)
        self.heard = []
        self.listen(FINDINGS, lambda message: self.heard.append(read_statuses(message)), CONSUMER)

    def onsets(self) -> Sequence[str]:
        """Names of the statuses on what has begun, in the last message."""
        return [one.name for one in self.heard[-1] if 'onset' in one.name] if self.heard else []


@pytest.fixture(scope='module')
def moving_bag(steady_tow, onset_samples, tmp_path_factory):
    path = tmp_path_factory.mktemp('onset') / 'bag'
    return steady_tow.write(path, onset_samples(12, BEGIN_S))


@pytest.fixture(scope='module')
def estimate(coarse_gear, tmp_path_factory):
    """Boards that are known well, as `trawl identify` writes it: by the prior little is told."""
    gear = load_gear(coarse_gear)
    values = dict(zip(COEFFICIENTS, gear.board.coefficients.array().tolist(), strict=True))
    known = {
        'coefficients': {name: {'value': value} for name, value in values.items()},
        'covariance': np.diag((0.2 * board_prior(gear).std) ** 2).tolist(),
    }
    path = tmp_path_factory.mktemp('known') / 'identification.json'
    path.write_text(json.dumps(known))
    return path


@pytest.fixture
def watching(coarse_gear, estimate, tmp_path):
    """Parameters of a node that watches."""
    book = tmp_path / 'book.jsonl'
    own = {'gear': coarse_gear, 'estimate': estimate, 'log_book': book}
    return {'watch': True, **{name: str(path) for name, path in own.items()}}


def _play(graph, bag, **parameters):
    player = graph.add(BagPlayer, bag=str(bag), wait_for=['discrepancy_node'], **parameters)
    graph.until(lambda: player.exit_code is not None, timeout_s=600.0)
    graph.remove(player)


@pytest.mark.slow
@pytest.mark.parametrize('rate', [0.0, 120.0])
def test_a_finding_is_published_acknowledged_and_kept(open_graph, moving_bag, watching, rate):
    book = Path(watching['log_book'])
    with open_graph() as graph:
        node = graph.add(DiscrepancyNode, **watching)
        bridge = graph.add(Bridge)
        graph.until(lambda: node.subscribers()[FINDINGS][0])
        _play(graph, moving_bag, rate=rate)
        graph.until(bridge.onsets, timeout_s=400.0)
        assert graph.call(ACKNOWLEDGE).success
        onset = next(one for one in bridge.heard[-1] if 'onset' in one.name)
        assert abs(float(onset.values['onset']) - BEGIN_S) < 180.0
        assert any(one.level == WARN and one.name == 'onset' for one in node.statuses())
        assert graph.call(DISMISS).success
        assert not graph.call(DISMISS).success
        node.finish_work()
    events = [event['event'] for event in LogBook(book).events()]
    assert events[:3] == ['begun', 'raised', 'published']
    assert events.index('acknowledged') < events.index('dismissed')
    published = next(one for one in LogBook(book).events() if one['event'] == 'published')
    assert 'bridge' in published['to']


@pytest.mark.slow
def test_a_bag_that_is_looped_is_two_tows_and_a_node_that_is_restarted_counts_on(
    open_graph, moving_bag, watching
):
    book = Path(watching['log_book'])
    for first in (1, 3):
        with open_graph() as graph:
            node = graph.add(DiscrepancyNode, **watching)
            for _ in range(2):
                _play(graph, moving_bag, rate=0.0)
            graph.until(node._idle, timeout_s=600.0)
            node.finish_work()
        raised = [one['finding'] for one in LogBook(book).events() if one['event'] == 'raised']
        assert raised[-2:] == [first, first + 1]


def test_nothing_is_watched_where_it_is_not_wanted(open_graph, coarse_gear, tmp_path):
    with open_graph() as graph:
        node = graph.add(partial(DiscrepancyNode), gear=str(coarse_gear))
        assert [one.name for one in node.statuses()] == ['discrepancy']
        node.finish_work()
