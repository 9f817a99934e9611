"""What a diagnoser may see of a trial: steady windows, as a JSON file."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from trawl_ros.identification.over_ground import GroundTrack
from trawl_ros.identification.window_records import SteadyWindow


def write_windows(path: Path, windows: Sequence[SteadyWindow]) -> None:
    """Write windows, whole or not at all."""
    text = json.dumps([asdict(window) for window in windows])
    beside = path.with_suffix('.part')
    beside.write_text(text + '\n', encoding='utf-8')
    beside.replace(path)


def read_windows(path: Path) -> tuple[SteadyWindow, ...]:
    """Read them again."""
    records = json.loads(path.read_text(encoding='utf-8'))
    return tuple(
        SteadyWindow(**{**record, 'track': GroundTrack(**record['track'])}) for record in records
    )
