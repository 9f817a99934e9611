"""The example of docs/guides/test_your_controller.md passes in an empty folder, and can fail."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

GUIDE = Path(__file__).parents[2] / 'docs' / 'guides' / 'test_your_controller.md'
FILES = dict(re.findall(r'```python (\S+)\n(.*?)```', GUIDE.read_text(encoding='utf-8'), re.S))

pytestmark = [pytest.mark.ros, pytest.mark.slow]


def outcome(folder, *, controller):
    """Run the test of the guide on a controller, and give what it says."""
    pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')
    for name, text in {**FILES, 'autotrawl.py': controller}.items():
        (folder / name).write_text(text, encoding='utf-8')
    command = (sys.executable, '-m', 'pytest', '-p', 'trawl_ros.testing', '-q', 'test_autotrawl.py')
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False).stdout


def test_the_example_passes(tmp_path):
    assert '2 passed' in outcome(tmp_path, controller=FILES['autotrawl.py'])


def test_a_controller_that_is_too_slow_and_trusts_its_cells_fails(tmp_path):
    good = FILES['autotrawl.py']
    bad = good.replace("'gain_m', 1.5", "'gain_m', 0.3").replace('math.isfinite(port) and', '')
    bad = bad.replace('math.isfinite(starboard)', 'True')
    assert '2 failed' in outcome(tmp_path, controller=bad)
