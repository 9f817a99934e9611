"""`discrepancy_node` raises a finding while tows go on, and writes the report at the end."""

import json
from functools import partial

import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from diagnostic_msgs.msg import DiagnosticArray  # noqa: E402

from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.messages.diagnostics import OK, WARN, read_statuses  # noqa: E402
from trawl_ros.messages.to_messages import sample_message  # noqa: E402
from trawl_ros.nodes.bag_player import BagPlayer  # noqa: E402
from trawl_ros.nodes.discrepancy_node import FINDINGS, FINISH, DiscrepancyNode  # noqa: E402
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.nodes.runtime.qos import CONSUMER  # noqa: E402
from trawl_ros.records.samples import WinchSample  # noqa: E402

pytestmark = pytest.mark.ros


class Listener(TrawlNode):
    """Hears findings."""

    SPECS = ()

    def __init__(self, **kwargs):
        super().__init__('listener', **kwargs)
        self.found = []
        self.listen(FINDINGS, self._take, CONSUMER)

    def _take(self, message: DiagnosticArray) -> None:
        self.found.append(read_statuses(message))


def test_cells_that_show_too_much_are_found_while_the_tows_go_on(
    open_graph, tight_tows, coarse_gear, tmp_path
):
    with open_graph() as graph:
        node = graph.add(
            DiscrepancyNode, gear=str(coarse_gear), output=str(tmp_path / 'report'),
            baseline_tows=1, settle_s=10.0, settle_passages=0.0, window_s=20.0,
        )  # fmt: skip
        listener = graph.add(Listener)
        assert node.statuses()[0].level == OK
        player = graph.add(
            BagPlayer, bag=str(tight_tows.path), rate=0.0, wait_for=['discrepancy_node']
        )
        graph.until(lambda: player.exit_code is not None)
        graph.remove(player)
        graph.until(lambda: listener.found and node._watching.idle, timeout_s=120.0)
        graph.settle()
        answer = graph.call(FINISH)
        assert answer.success
        assert 'tension cell' in answer.message
        verdict, *findings = listener.found[-1]
        assert verdict.values['verdict'] in ('NAMED', 'AMBIGUOUS')
        assert verdict.level == WARN
        (finding,) = findings
        assert finding.name == 'discrepancy: tension_cell'
        assert float(finding.values['scale low']) < float(finding.values['scale'])
        assert node.statuses()[0].level == WARN
        node.finish_work()
        # As windows of bags have it: by it bottom contact is ruled out.
        assert {window.seabed for window in node._windows} == {tight_tows.seabed}
    written = json.loads((tmp_path / 'report' / 'diagnosis.json').read_text())
    assert written['verdict'] == verdict.values['verdict']
    assert (tmp_path / 'report' / 'report.html').exists()


def test_two_sources_that_one_publisher_passes_on_are_told_and_not_used(open_graph, coarse_gear):
    topic, lengths = 'winch/joint_states', (500.0, 500.0)
    told = [
        WinchSample(SECOND + round(time * SECOND), lengths, (0.0, 0.0), (factor * 3e4, 3e4))
        for rate, factor in ((10, 1.0), (3, 1.15))
        for time in (number / rate for number in range(8 * rate))
    ]
    with open_graph() as graph:
        node = graph.add(DiscrepancyNode, gear=str(coarse_gear))
        source = graph.add(partial(TrawlNode, 'source'))
        source.advertise(topic)
        graph.until(lambda: source.subscribers()[topic][0])
        for sample in sorted(told, key=lambda sample: sample.stamp):
            source.send(*sample_message(sample))
        graph.until(lambda: 'has two sources' in node.all_statuses()[0].message)
        assert node._finder.arrived['port_tension'] < len(told) / 2
