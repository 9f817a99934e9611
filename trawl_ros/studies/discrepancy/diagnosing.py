"""Diagnoses a trial of which nothing is known but a file of windows, or bags."""

from dataclasses import dataclass
from pathlib import Path

from trawl_ros.diagnosis.diagnosis import diagnose
from trawl_ros.diagnosis.result import result
from trawl_ros.files import write_json
from trawl_ros.studies.discrepancy.tows import BASELINE
from trawl_ros.studies.discrepancy.windows_file import read_windows
from trawl_ros.studies.identification.plant import Cut


@dataclass(frozen=True)
class Case:
    """A file of windows, where the diagnosis goes, and the gear as it is believed."""

    windows: Path
    diagnosis: Path
    gear: str
    cut: Cut


def diagnose_case(case: Case) -> str:
    """Diagnose, write the diagnosis, and give its verdict."""
    windows = read_windows(case.windows)
    tows = [f'tow {number + 1}' for number in range(1 + max(window.tow for window in windows))]
    found = diagnose(case.cut.model(case.gear), windows, tows, frozenset(range(BASELINE)))
    write_json(case.diagnosis, result(found, ()))
    return found.verdict
