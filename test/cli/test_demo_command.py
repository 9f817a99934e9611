"""``trawl demo``: the whole chain, each node a process of its own."""

import json

import pytest

pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from trawl_ros import tow
from trawl_ros.bags.reader import Bag, summarise
from trawl_ros.lab.demo.command import topics_of_channels
from trawl_ros.nodes.playback.replay import replayed
from trawl_ros.records.channels import CHANNELS, REQUIRED
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.records.topics import NAMESPACE, TRUTH, absolute

pytestmark = pytest.mark.ros

SHORT = """\
description: one steady state and a little more
gear: coarse.yaml
heading_deg: 90.0
start: {warp_length_m: 200.0, speed_m_s: 2.3}
steps:
  - {name: hold, minutes: 6.8}
  - {name: veer, minutes: 0.2, warp_length_m: 205.0}
truth_rate_hz: 1.0
"""


@pytest.mark.slow
@pytest.mark.timeout(600)
def test_the_chain_loses_nothing_and_ends_with_an_estimate(run, trial, tmp_path):
    trial.write_text(SHORT)
    out = tmp_path / 'demo'
    done = run('demo', '--scenario', trial, '--out', out, '--no-diagnosis')
    assert done.exit_code == 0, done.output
    summary = json.loads((out / 'summary.json').read_text())
    assert summary['finished'] is True
    assert summary['minutes_at_sea'] == pytest.approx(7.0)
    assert summary['windows'] >= 1
    assert list(summary['coefficients']) == list(COEFFICIENTS)
    assert summary['coefficients']['a1']['truth'] == pytest.approx(1.19)
    assert summary['messages_lost'] == 0
    for count in summary['messages'].values():
        assert count['published'] == count['recorded']
    truth = absolute('truth/winch')
    assert summary['messages'][truth]['recorded'] == 421
    counts = {topic.topic: topic.count for topic in summarise(out / 'bag').topics}
    for topic in TRUTH:
        assert counts[absolute(topic.name)] == summary['messages'][absolute(topic.name)]['recorded']
    assert json.loads((out / 'identification.json').read_text())['windows'] == summary['windows']
    assert len(list(out.glob('*.png'))) >= 3
    assert set(summary['figures']) == {path.name for path in out.glob('*.png')}
    assert not (out / 'hidden').exists()


def test_the_replay_asks_for_topics_that_the_bag_has(trial, tmp_path):
    tow(trial, tmp_path / 'bag')
    wanted = topics_of_channels(tmp_path / 'bag')
    played, left_out = replayed(Bag(tmp_path / 'bag'), wanted, NAMESPACE)
    assert sorted(played) == sorted(wanted)
    assert left_out == []
    assert {absolute(CHANNELS[name].topic) for name in REQUIRED} <= played.keys()


def test_a_folder_of_somebody_else_is_refused_before_anything_starts(run, tmp_path):
    (tmp_path / 'mine').write_text('mine')
    done = run('demo', '--out', tmp_path)
    assert done.exit_code == 1
    assert str(tmp_path) in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ['mine']


@pytest.mark.slow
def test_a_tow_that_cannot_start_ends_the_demo_with_the_node_s_words(run, trial, tmp_path):
    trial.write_text(SHORT.replace('warp_length_m: 200.0', 'warp_length_m: 10.0'))
    done = run('demo', '--scenario', trial, '--out', tmp_path / 'demo')
    assert done.exit_code == 1
    assert 'sim_node' in done.stderr
    assert 'warp 10 m at 2.3 m/s' in done.stderr
