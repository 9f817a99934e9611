"""Valid MCAP is read whatever its writer left out of the summary."""

import csv

import pytest
from click.testing import CliRunner
from mcap.writer import IndexType

from trawl_ros.bags.check import check_bag
from trawl_ros.bags.reader import Bag
from trawl_ros.bags.repair import repair_bag
from trawl_ros.bags.samples import SampleStream
from trawl_ros.cli.main import trawl
from trawl_ros.records.topics import NAMESPACE

WITH_INDEX = [
    {'repeat_channels': False},
    {'repeat_schemas': False},
    {'repeat_channels': False, 'repeat_schemas': False},
    {'use_summary_offsets': False},
    {'enable_crcs': False},
    {'enable_data_crcs': True},
    {'repeat_channels': False, 'repeat_schemas': False, 'index_types': IndexType.CHUNK},
]
WITHOUT_INDEX = [
    {'use_statistics': False},
    {'use_chunking': False},
    {'index_types': IndexType.NONE},
    {'repeat_channels': False, 'repeat_schemas': False, 'use_chunking': False},
    {
        'repeat_channels': False,
        'repeat_schemas': False,
        'use_statistics': False,
        'use_summary_offsets': False,
        'index_types': IndexType.NONE,
    },
]


def name(options):
    return ' '.join(options)


@pytest.mark.parametrize('options', WITH_INDEX + WITHOUT_INDEX, ids=name)
def test_all_of_it_is_read(bag_path, mcap_path, messages, raw, rewrite, options):
    rewrite(mcap_path, **options)
    assert raw(bag_path) == (messages, [])
    samples = SampleStream([mcap_path], NAMESPACE)
    assert sum(1 for _ in samples) == len(messages)


@pytest.mark.parametrize('options', WITH_INDEX, ids=name)
def test_it_is_sound(bag_path, mcap_path, rewrite, options):
    rewrite(mcap_path, **options)
    assert check_bag(bag_path).findings == ()
    assert repair_bag(bag_path).out is None


@pytest.mark.parametrize('options', WITHOUT_INDEX, ids=name)
def test_an_index_can_be_made(bag_path, mcap_path, messages, rewrite, options):
    rewrite(mcap_path, **options)
    assert [finding.kind for finding in check_bag(bag_path).findings] == ['index']
    done = repair_bag(bag_path)
    assert done.whole
    assert [(m.topic, m.type, m.data, m.log_time) for m in Bag(done.out).raw()] == messages


def test_its_tables_have_all_rows(bag_path, mcap_path, tmp_path, rewrite):
    rewrite(mcap_path, repeat_channels=False, repeat_schemas=False)
    done = CliRunner().invoke(trawl, ['bag', 'export', str(bag_path), '--out', f'{tmp_path}/out'])
    assert done.exit_code == 0
    with (tmp_path / 'out/trawl.winch.joint_states.csv').open(newline='') as stream:
        assert len(list(csv.DictReader(stream))) == 300
