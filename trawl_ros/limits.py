"""Limits of what is taken from foreign files and messages, in one table.

Each is applied before memory is taken or time is spent. What stands here is all there is: readers
import a limit from this table, and `docs/limits.md` is held equal to it by a test.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Limit:
    """A bound of what a file or message may ask for.

    Attributes
    ----------
    value
        The largest that is accepted.
    unit
        Of the value; empty for a count that ``what`` names.
    what
        What is bounded.
    """

    value: int
    unit: str
    what: str

    def __str__(self) -> str:
        return f'{self.value} {self.unit}'.strip()


YAML_BYTES = Limit(1_000_000, 'bytes', 'size of a YAML file of the project')
YAML_DEPTH = Limit(20, 'levels', 'nesting of a YAML file of the project')
YAML_VALUES = Limit(20_000, 'values', 'keys and values in a YAML file of the project')

MESSAGE_BYTES = Limit(100_000, 'bytes', 'size of a message that a node decodes')
SCAN_BYTES = Limit(5_000_000, 'bytes', 'size of a LaserScan, DiagnosticArray or MarkerArray')
IMAGE_BYTES = Limit(100_000_000, 'bytes', 'size of an Image or PointCloud2')
SENTENCE = Limit(300, 'characters', 'what a node says of a message, in its log and diagnostics')
CONSUMERS = Limit(100, '', 'consumers that a source takes note of')

TABLE: dict[str, Limit] = {
    name: limit for name, limit in list(globals().items()) if isinstance(limit, Limit)
}
"""All limits by their names, in the order of this file."""
