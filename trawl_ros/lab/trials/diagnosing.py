# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Blind diagnosis of a trial from a file of windows, or a folder of bags."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from trawl_ros.core.files import write_json
from trawl_ros.diagnosis.procedure import diagnose_windows
from trawl_ros.diagnosis.report.result import result
from trawl_ros.estimation.bag_windows import BagTask, read_tow
from trawl_ros.estimation.tows import numbered
from trawl_ros.estimation.windows.over_ground import GroundTrack
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.records.topics import NAMESPACE


def write_windows(path: Path, windows: Sequence[SteadyWindow]) -> None:
    """Write windows completely or not at all."""
    write_json(path, [asdict(window) for window in windows])


def read_windows(path: Path) -> tuple[SteadyWindow, ...]:
    """Read windows."""
    records = json.loads(path.read_text(encoding='utf-8'))
    return tuple(
        SteadyWindow(**{**record, 'track': GroundTrack(**record['track'])}) for record in records
    )


@dataclass(frozen=True)
class DiagnosisTask:
    """Case of a blind diagnosis.

    Attributes
    ----------
    seen
        Visible data.
    diagnosis
        File of the result.
    gear
        Gear file as it is known aboard.
    baseline
        Number of first tows that form the baseline.
    """

    seen: Path
    diagnosis: Path
    gear: Path
    baseline: int


def diagnose_case(case: DiagnosisTask) -> str:
    """Diagnose, write the diagnosis, and return its verdict."""
    gear = load_gear(case.gear)
    windows, tows = _of_bags(case.seen, gear) if case.seen.is_dir() else _of_file(case.seen)
    found = diagnose_windows(gear, windows, tows, frozenset(range(case.baseline)))
    write_json(case.diagnosis, result(found, ()))
    return found.verdict


def _of_file(path: Path) -> tuple[list[SteadyWindow], list[str]]:
    windows = list(read_windows(path))
    return windows, [f'tow {number + 1}' for number in range(1 + max(w.tow for w in windows))]


def _of_bags(folder: Path, gear: GearRecord) -> tuple[list[SteadyWindow], list[str]]:
    return numbered([read_tow(BagTask(bag, gear, NAMESPACE)) for bag in sorted(folder.iterdir())])
