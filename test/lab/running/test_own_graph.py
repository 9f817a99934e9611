"""Two graphs at once are in domains of their own, whoever made them."""

import os
import re
import socket
import subprocess
import sys
from contextlib import ExitStack
from fcntl import LOCK_EX, flock
from pathlib import Path
from tempfile import gettempdir

import pytest

from trawl_ros.core.errors import TrawlError
from trawl_ros.lab.running import own_graph as module
from trawl_ros.lab.running.own_graph import DOMAINS, own_graph

ROOT = Path(__file__).resolve().parents[3]
OTHER = """\
import sys
from pathlib import Path
from trawl_ros.lab.running import own_graph as module
module.DOMAINS = (int(sys.argv[1]),)
with module.own_graph(Path('log')) as graph:
    print(graph['ROS_DOMAIN_ID'], flush=True)
    sys.stdin.read()
"""


def domain(graph):
    return int(graph['ROS_DOMAIN_ID'])


@pytest.fixture
def domains(monkeypatch):
    """Leave only so many to choose from."""
    return lambda *left: monkeypatch.setattr(module, 'DOMAINS', left)


@pytest.fixture
def unused():
    """Domains of which no suite leases any, while no other suite runs the tests of this file."""
    with (Path(gettempdir()) / 'trawl_ros-own-graph.lock').open('w') as lock:
        flock(lock, LOCK_EX)
        yield [number for number in range(70, 102) if module._silent(number)]


def test_as_many_at_once_as_there_are_domains_share_none(tmp_path, domains, unused):
    domains(*unused[:8])
    with ExitStack() as stack:
        graphs = [stack.enter_context(own_graph(tmp_path)) for _ in range(8)]
        assert {domain(graph) for graph in graphs} == set(unused[:8])
        with pytest.raises(TrawlError, match='all in use'):
            stack.enter_context(own_graph(tmp_path))
    with own_graph(tmp_path):
        pass


def test_a_process_holds_its_domain_against_another_until_it_is_killed(tmp_path, domains, unused):
    number = unused[0]
    domains(number)
    with subprocess.Popen(
        [sys.executable, '-c', OTHER, str(number)], cwd=tmp_path,
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
    ) as other:  # fmt: skip
        assert other.stdout.readline() == f'{number}\n'
        with pytest.raises(TrawlError), own_graph(tmp_path):
            pass
        other.kill()
        other.wait()
    with own_graph(tmp_path) as graph:
        assert domain(graph) == number


def test_a_domain_in_which_another_program_has_a_node_is_left_to_it(tmp_path, domains, unused):
    taken, free = unused[:2]
    domains(taken, free)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as node:
        node.bind(('127.0.0.1', 7410 + 250 * taken))
        for _ in range(5):
            with own_graph(tmp_path) as graph:
                assert domain(graph) == free


def test_this_run_of_tests_holds_the_domain_of_its_environment(tmp_path, domains):
    own = int(os.environ['ROS_DOMAIN_ID'])
    assert own in DOMAINS
    domains(own)
    with pytest.raises(TrawlError, match='all in use'), own_graph(tmp_path):
        pass


def test_no_test_and_no_command_names_a_domain():
    fixed = re.compile(r"DOMAIN_ID(=|': ')\d|domain_id=\d|^DOMAINS? = \(?\d", re.M)
    named = {
        file.relative_to(ROOT).as_posix()
        for folder in ('test', 'trawl_ros')
        for file in (ROOT / folder).rglob('*.py')
        if fixed.search(file.read_text(encoding='utf-8'))
    }
    assert not named
