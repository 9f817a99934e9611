"""What one module of the benchmark found."""

from dataclasses import dataclass

from trawl_ros.benchmark.row import Row
from trawl_ros.validation.check import Drawing


@dataclass(frozen=True)
class Findings:
    """Rows of the report, the figures beside them, and how they were measured, in words."""

    rows: tuple[Row, ...]
    drawings: tuple[Drawing, ...] = ()
    text: str = ''
