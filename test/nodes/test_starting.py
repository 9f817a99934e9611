"""A node that is told to end while it is imported ends at once, without a traceback."""

import signal
import subprocess
import sys
import time

import pytest

from trawl_ros.nodes import starting

SCRIPT = """
import sys, time
class Slow:
    def find_spec(self, name, path=None, target=None):
        if name == 'trawl_ros.nodes.sim_node':
            print('importing', flush=True)
            time.sleep(30)
sys.meta_path.insert(0, Slow())
from trawl_ros.nodes.starting import sim_node
sys.exit(sim_node())
"""


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_a_signal_during_the_imports_is_a_clean_end(number):
    with subprocess.Popen(
        [sys.executable, '-c', SCRIPT], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout.readline() == 'importing\n'
        began = time.monotonic()
        process.send_signal(number)
        _, errors = process.communicate(timeout=20)
    assert (process.returncode, errors) == (0, '')
    assert time.monotonic() - began < 5


def test_only_names_of_nodes_are_entry_points():
    assert callable(starting.bag_player)
    with pytest.raises(AttributeError):
        getattr(starting, '__path__')  # noqa: B009
