"""A tow of which everything is known, with what was estimated from it, and recordings read back."""

import runpy
from collections import defaultdict
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from trawl_ros.bags.writer import BagWriter
from trawl_ros.core.time import SECOND
from trawl_ros.messages.cdr import serialize
from trawl_ros.messages.commands import winch_command
from trawl_ros.messages.diagnostics import OK, WARN, Status, diagnostic_array
from trawl_ros.messages.estimates import ChannelInnovation, innovation_message
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.records.topics import absolute

KNOWN = runpy.run_path(str(Path(__file__).parents[1] / 'plots' / 'conftest.py'))
START, DURATION_S = KNOWN['START'], KNOWN['DURATION_S']
WINDOWS_AT_S = (30, 60, 90)
INNOVATION, DEVIATION = -1.5, 0.5
FINDING = 'a current from starboard'


def interval(name: str, window: int) -> tuple[float, float, float]:
    """Value, low and high of a coefficient: each window narrows it."""
    value = 1.0 + COEFFICIENTS.index(name)
    return value, value - 1.0 / window, value + 1.0 / window


def estimate_messages():
    """Statuses, innovations, findings and commands as the nodes publish them, with stamps."""
    for window, second in enumerate(WINDOWS_AT_S, 1):
        stamp = START + second * SECOND
        values = {'windows': str(window)}
        for name in COEFFICIENTS:
            value, low, high = interval(name, window)
            values |= {
                name: f'{value:.9g}',
                f'{name} low': f'{low:.6g}',
                f'{name} high': f'{high:.6g}',
                f'{name} determined': 'true',
            }
        status = Status('identification: coefficients', OK, f'{window} windows used', values)
        yield stamp, 'identification/status', diagnostic_array(stamp, [status])
        # It is told again and again, and shown once.
        yield stamp, 'identification/status', diagnostic_array(stamp, [status])
        channels = [ChannelInnovation('door_spread', INNOVATION, DEVIATION, 0.4)]
        yield stamp, *innovation_message(stamp, channels)
    finding = Status('discrepancy: verdict', WARN, FINDING, {'verdict': 'NAMED', 'windows': '3'})
    yield stamp, 'discrepancy/findings', diagnostic_array(stamp, [finding])
    yield stamp, *winch_command(stamp, 400.0, np.nan)


@pytest.fixture(scope='session')
def known() -> SimpleNamespace:
    """What is known of the tow."""
    names = ('truth_at', 'picture_of', 'samples_of', 'sweep_of', 'write_tow', 'LENGTH', 'MOUTH')
    return SimpleNamespace(
        START=START,
        DURATION_S=DURATION_S,
        WINDOWS_AT_S=WINDOWS_AT_S,
        FINDING=FINDING,
        DEVIATIONS=INNOVATION / DEVIATION,
        interval=interval,
        estimate_messages=estimate_messages,
        **{name: KNOWN[name] for name in names},
    )


@pytest.fixture(scope='session')
def tow(tmp_path_factory) -> Path:
    """The whole tow as a bag."""
    return KNOWN['write_tow'](tmp_path_factory.mktemp('view') / 'tow')


@pytest.fixture(scope='session')
def readings(tmp_path_factory) -> Path:
    """Its readings alone."""
    return KNOWN['write_tow'](tmp_path_factory.mktemp('view') / 'readings', ['instruments'])


@pytest.fixture(scope='session')
def estimates(tmp_path_factory) -> Path:
    """What was estimated from it, in a bag of its own."""
    path = tmp_path_factory.mktemp('view') / 'estimates'
    with BagWriter(path) as bag:
        for stamp, topic, message in estimate_messages():
            bag.write(absolute(topic), message.__msgtype__, serialize(message), stamp)
    return path


class Recording:
    """Recording read back: the rows of each entity, by component."""

    def __init__(self, path: Path) -> None:
        try:
            from rerun.chunk import RrdReader
        except ImportError:  # before 0.40
            from rerun.experimental import RrdReader
        reader = RrdReader(path)
        self.applications = {entry.application_id for entry in reader.recordings()}
        self.blueprints = len(reader.blueprints())
        self.timelines: set[str] = set()
        self.kinds: set[str] = set()
        self.static: dict[str, dict[str, list]] = {}
        self._rows = defaultdict(list)
        for chunk in reader.stream():
            batch = chunk.to_record_batch()
            columns = {
                field.name: column.to_pylist()
                for field, column in zip(batch.schema, batch.columns, strict=True)
                if ':' in field.name
            }
            path = str(chunk.entity_path)
            if chunk.is_static:
                self.static[path] = {name: rows[0] for name, rows in columns.items()}
                continue
            self.timelines |= set(chunk.timeline_names)
            (timeline,) = chunk.timeline_names
            times = batch.column(timeline)
            self.kinds.add(str(times.type))
            for k, time in enumerate(times.cast('int64').to_pylist()):
                row = {name.rpartition(':')[2]: rows[k] for name, rows in columns.items()}
                self._rows[path].append((time, row))

    @property
    def entities(self) -> set[str]:
        return set(self._rows)

    def rows(self, path: str) -> list:
        """Stamp (ns) and components of each row of an entity, by time."""
        return sorted(self._rows[path], key=lambda row: row[0])

    def series(self, path: str) -> tuple[np.ndarray, np.ndarray]:
        """Stamps (ns) and values of an entity with scalars."""
        rows = self.rows(path)
        return np.array([t for t, _ in rows]), np.array([row['scalars'][0] for _, row in rows])


@pytest.fixture(scope='session')
def read_back():
    """Give the class that reads a recording."""
    return Recording
