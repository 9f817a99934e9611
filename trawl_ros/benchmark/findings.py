"""What one module of the benchmark found."""

from dataclasses import dataclass, replace
from importlib.util import find_spec

from trawl_ros.benchmark.row import Row
from trawl_ros.validation.check import Drawing


@dataclass(frozen=True)
class Findings:
    """Rows of the report, the figures beside them, and how they were measured, in words."""

    rows: tuple[Row, ...]
    drawings: tuple[Drawing, ...] = ()
    text: str = ''


def without_ros(asked: Row) -> Findings | None:
    """Say of a figure without a value yet that it needs ROS 2; None where that is there."""
    if find_spec('rclpy') is not None:
        return None
    note = 'rclpy is not installed; it is part of ROS 2, or of the extra `ros`'
    return Findings((replace(asked, note=note),))
