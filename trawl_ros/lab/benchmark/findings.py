"""Findings of one benchmark module."""

from dataclasses import dataclass, replace
from importlib.util import find_spec

from trawl_ros.lab.benchmark.row import BenchmarkRow
from trawl_ros.lab.report.check import CaseFigure


@dataclass(frozen=True)
class Findings:
    """Findings: rows of the report, figures, and a description of the measurement."""

    rows: tuple[BenchmarkRow, ...]
    drawings: tuple[CaseFigure, ...] = ()
    text: str = ''


def without_ros(asked: BenchmarkRow) -> Findings | None:
    """Return findings that say ROS 2 is missing for this row; None where it is installed."""
    if find_spec('rclpy') is not None:
        return None
    note = 'rclpy is not installed; it is part of ROS 2, or of the extra `ros`'
    return Findings((replace(asked, note=note),))
