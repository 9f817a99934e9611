# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Limits of foreign files and messages, in one table.

Each is applied before memory or time is spent. The table is complete: readers import their limits
from it, and the site lists it.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Limit:
    """Limit of a foreign file or message.

    Attributes
    ----------
    value
        Largest accepted value.
    unit
        Unit of the value; empty for a count named by ``what``.
    what
        Limited quantity, in words.
    """

    value: int
    unit: str
    what: str

    def __str__(self) -> str:
        return f'{self.value} {self.unit}'.strip()


YAML_BYTES = Limit(1_000_000, 'bytes', 'size of a YAML file of the project')
YAML_DEPTH = Limit(20, 'levels', 'nesting of a YAML file of the project')
YAML_VALUES = Limit(20_000, 'values', 'keys and values in a YAML file of the project')
YAML_NUMBER = Limit(10**18, '', 'magnitude of a number in a YAML or JSON file of the project')
JSON_BYTES = Limit(50_000_000, 'bytes', 'size of a JSON file of the project, such as `estimate`')
GEAR_NODES = Limit(30_000, 'nodes', 'nodes of the net of a gear file')

MESSAGE_BYTES = Limit(100_000, 'bytes', 'size of a message that a node decodes')
SCAN_BYTES = Limit(5_000_000, 'bytes', 'size of a LaserScan, DiagnosticArray or MarkerArray')
IMAGE_BYTES = Limit(100_000_000, 'bytes', 'size of an Image or PointCloud2')
SENTENCE = Limit(300, 'characters', 'text about a message, in log and diagnostics of a node')
DIAGNOSIS = Limit(1000, 'characters', 'a sentence or value on /diagnostics, or about a record')
TRUTH = Limit(10**9, '', 'magnitude of a number in truth, in the units of ROS')
CONSUMERS = Limit(100, '', 'consumers known to a source')
VIEWERS = Limit(20, '', 'viewers of `foxglove_node`')
SUBSCRIPTIONS = Limit(1000, '', 'subscriptions of a viewer of `foxglove_node`')
DEFINITION_BYTES = Limit(256_000, 'bytes', 'text of the definition of a message type in a bag')
DEFINITION_FIELDS = Limit(2000, 'fields', 'such a definition, including nested types')
DEFINITION_VALUES = Limit(
    1000, 'values', 'a message without its sequences, an array of numbers counting as one'
)
DEFINITION_DEPTH = Limit(20, 'levels', 'types within types')
BAG_TOPICS = Limit(5000, 'topics', 'a bag')
BAG_FIELDS = Limit(20_000, 'fields', 'all definitions of a bag that are not those of ROS 2 Jazzy')
NAME = Limit(1000, 'characters', 'name of a topic, type or file in a bag')
BAG_FILES = Limit(1000, 'files', 'a bag')
CHUNK_BYTES = Limit(256 << 20, 'bytes', 'a chunk, record or message of a bag, unpacked')
MESSAGE_OBJECTS = Limit(4_000_000, '', 'strings, records and their values in one message')
BAG_MESSAGES = Limit(500_000, 'messages', 'a file of a bag, and one more per 8 bytes of the file')
BAG_UNPACKED = Limit(
    512 << 20, 'bytes', 'what a file of a bag unpacks to, and 200 more per byte of the file'
)
BAG_WAITING = Limit(512 << 20, 'bytes', 'chunks that overlap in time, so that all are held at once')
BAG_OPERATIONS = Limit(
    50_000_000, 'steps of SQLite', 'reading a database, and 20 more per byte of the file'
)
RECOVERED_CHANNELS = Limit(500, 'topics', 'a file of a bag whose lost descriptions are searched')
RECOVERED_RECORDS = Limit(2000, '', 'descriptions of topics taken out of damaged parts of a file')
METADATA_BYTES = Limit(4_000_000, 'bytes', 'metadata.yaml of a bag')
METADATA_VALUES = Limit(500_000, 'values', 'metadata.yaml, aliases written out')
METADATA_DEPTH = Limit(20, 'levels', 'nesting of metadata.yaml')
LOG_READINGS = Limit(2_000_000, 'readings', 'a log that is imported, held for sorting')
PROBE_BYTES = Limit(50_000_000, 'bytes', 'a file of Notus, eSonar, NetMind or Scanmar')
LOG_NULS = Limit(100_000_000, 'bytes', 'NULs in a row in a log, as after a loss of power')
LATEST_STAMP = Limit(2**63 - 1, 'ns', 'log time of a message, since 1970')

TABLE: dict[str, Limit] = {
    name: limit for name, limit in list(globals().items()) if isinstance(limit, Limit)
}
"""All limits by their names, in the order of this file."""
