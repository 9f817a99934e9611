"""Visible data of a trial: steady windows, as a JSON file."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from trawl_ros.core.files import write_json
from trawl_ros.estimation.windows.over_ground import GroundTrack
from trawl_ros.estimation.windows.records import SteadyWindow


def write_windows(path: Path, windows: Sequence[SteadyWindow]) -> None:
    """Write windows, whole or not at all."""
    write_json(path, [asdict(window) for window in windows])


def read_windows(path: Path) -> tuple[SteadyWindow, ...]:
    """Read windows."""
    records = json.loads(path.read_text(encoding='utf-8'))
    return tuple(
        SteadyWindow(**{**record, 'track': GroundTrack(**record['track'])}) for record in records
    )
