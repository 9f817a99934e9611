"""A current that the model lacks, on the gear that ships, through commands and nodes.

Tows in a current that the model does not know are diagnosed, the current is named, the repaired
gear is towed by `sim_node` and recorded, and leaves nothing to explain in the first tows.
"""

import json
import math

import pytest
import yaml

pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from rich.console import Console

from trawl_ros.bags.reader import summarise
from trawl_ros.bags.samples import SampleStream
from trawl_ros.lab.demo.hidden import AGAIN, FOUND, REPAIRED, hidden_effect

pytestmark = [pytest.mark.ros, pytest.mark.slow, pytest.mark.timeout(1200)]

TOWED_S = 480.0


@pytest.fixture(scope='module')
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp('hidden')
    hidden_effect(folder, Console(quiet=True))
    return folder


def read(folder, name):
    return json.loads((folder / name / 'diagnosis.json').read_text())


def test_the_current_is_named_and_the_repaired_gear_leaves_nothing(folder):
    found = read(folder, FOUND)
    assert found['verdict'] == 'NAMED'
    assert [effect['name'] for effect in found['effects']] == ['current_shear']
    assert found['excess_removed'] > 0.5
    assert (folder / FOUND / 'gap.png').exists()
    assert read(folder, AGAIN)['verdict'] == 'NO_DISCREPANCY'


def test_the_repaired_gear_is_towed_by_the_node_and_recorded(folder):
    model = folder / FOUND / 'model.yaml'
    assert [effect['name'] for effect in yaml.safe_load(model.read_text())['effects']] == [
        'current_shear'
    ]
    counts = {topic.topic: topic.count for topic in summarise(folder / REPAIRED).topics}
    assert counts['/trawl/winch/joint_states'] > TOWED_S
    samples = SampleStream([folder / REPAIRED], 'trawl')
    tensions = [t for _, sample in samples for t in getattr(sample, 'tensions', ())]
    assert tensions
    assert all(math.isfinite(tension) and tension > 1e4 for tension in tensions)
