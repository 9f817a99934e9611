"""A node that is started again with the same parameters works, and overwrites nothing."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from trawl_ros.bags.reader import Bag
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import free_path
from trawl_ros.nodes.bag_recorder import BagRecorder
from trawl_ros.nodes.discrepancy_node import DiscrepancyNode
from trawl_ros.nodes.identification_node import IdentificationNode
from trawl_ros.nodes.view_node import ViewNode

pytestmark = pytest.mark.ros

WRITERS = {BagRecorder: 'bag', DiscrepancyNode: 'report', IdentificationNode: 'fit'}
RECORDER = """\
import sys
from trawl_ros.nodes.bag_recorder import main
sys.exit(main())
"""


def files_below(folder):
    return {file: file.read_bytes() for file in folder.rglob('*') if file.is_file()}


@pytest.mark.parametrize(('kind', 'name'), WRITERS.items())
def test_each_run_has_a_place_of_its_own(open_graph, tmp_path, capfd, kind, name):
    output = tmp_path / name
    before = {}
    for run in range(3):
        with open_graph() as graph:
            node = graph.add(kind, output=str(output))
            graph.rest(0.2)
            assert node.exit_code is None
        kept = files_below(tmp_path)
        assert {file: kept[file] for file in before} == before
        before = kept
        taken = output if run == 0 else tmp_path / f'{name}_{run + 1}'
        if kind is BagRecorder:
            assert Bag(taken).problems == []
        elif not any(taken.glob('*')):
            taken.mkdir(exist_ok=True)
            (taken / 'report.txt').write_text(f'of run {run}')
            before = files_below(tmp_path)
    said = capfd.readouterr().err
    assert f'parameter output: {output} exists already' in said
    assert '--force' not in said


def test_a_recording_of_the_viewer_keeps_its_suffix(open_graph, tmp_path, capfd):
    (tmp_path / 'live.rrd').write_bytes(b'a tow')
    with open_graph() as graph:
        graph.add(ViewNode, output=str(tmp_path / 'live.rrd'))
    assert f'this run writes {tmp_path / "live_2.rrd"}' in capfd.readouterr().err
    assert (tmp_path / 'live.rrd').read_bytes() == b'a tow'


def test_a_place_that_cannot_be_written_names_the_parameter(open_graph, tmp_path):
    (tmp_path / 'file').write_text('kept')
    with open_graph() as graph, pytest.raises(TrawlError, match=r'^parameter output: '):
        graph.add(DiscrepancyNode, output=str(tmp_path / 'file' / 'report'))


def test_a_killed_recorder_is_started_again_with_the_same_command(tmp_path):
    command = [sys.executable, '-c', RECORDER, '--ros-args', '-p', f'output:={tmp_path}/bag']
    for number in (signal.SIGKILL, signal.SIGINT):
        with subprocess.Popen(command, stderr=subprocess.PIPE, env=dict(os.environ)) as recorder:
            # Its first line comes when it is up.
            assert recorder.stderr.readline()
            recorder.send_signal(number)
            recorder.stderr.read()
        assert recorder.returncode == (-signal.SIGKILL if number == signal.SIGKILL else 0)
    assert Bag(tmp_path / 'bag_2').problems == []


@pytest.mark.parametrize(
    ('there', 'wanted', 'suffix', 'free'),
    [
        ((), 'bag', '', 'bag'),
        (('bag', 'bag_2'), 'bag', '', 'bag_3'),
        (('2026.11.28',), '2026.11.28', '', '2026.11.28_2'),
        (('live.rrd',), 'live.rrd', '.rrd', 'live_2.rrd'),
    ],
)
def test_a_number_is_put_behind_a_name_that_is_taken(tmp_path, there, wanted, suffix, free):
    for name in there:
        (tmp_path / name).mkdir()
    assert free_path(tmp_path / wanted, suffix=suffix) == tmp_path / free


def test_an_empty_folder_may_be_used_and_a_dangling_link_is_taken(tmp_path):
    (tmp_path / 'empty').mkdir()
    assert free_path(tmp_path / 'empty', or_empty=True) == tmp_path / 'empty'
    (tmp_path / 'link').symlink_to(Path('nowhere'))
    assert free_path(tmp_path / 'link', or_empty=True) == tmp_path / 'link_2'
