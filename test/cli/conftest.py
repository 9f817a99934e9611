"""Running the command, and small trials."""

from collections.abc import Callable
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from trawl_ros.cli.main import trawl

SECOND = 1_000_000_000
LEGS = ((200.0, 2.3), (220.0, 2.3))

TRIAL = """\
description: a few seconds of towing
gear: coarse.yaml
seed: 5
heading_deg: 90.0
start: {warp_length_m: 500.0, speed_m_s: 2.1}
steps:
  - {name: hold, minutes: 0.05}
  - {name: veer, minutes: 0.05, warp_length_m: 510.0}
"""


@pytest.fixture
def run() -> Callable[..., Result]:
    """Run ``trawl`` with arguments in this process."""
    return lambda *arguments: CliRunner().invoke(trawl, [str(part) for part in arguments])


@pytest.fixture
def trial(coarse_gear: Path, tmp_path: Path) -> Path:
    """A scenario of six seconds."""
    path = tmp_path / 'trial.yaml'
    path.write_text(TRIAL)
    (tmp_path / 'coarse.yaml').write_bytes(coarse_gear.read_bytes())
    return path
