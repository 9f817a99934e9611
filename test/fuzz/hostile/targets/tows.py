"""Tows as `trawl identify` reads them: readings of any kind in bags that are whole or damaged."""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from hypothesis import strategies as st
from hypothesis.strategies import DrawFn

from hostile.mutations import mutated
from hostile.target import Target, one_file
from hostile.targets.checkpoints import gear
from hostile.targets.messages import values
from trawl_ros.bags.writer import BagWriter
from trawl_ros.estimation.bag_windows import BagTask, read_tow
from trawl_ros.messages.cdr import serialize
from trawl_ros.messages.from_messages import SAMPLE_TOPICS
from trawl_ros.records.topics import TOPICS, absolute

FILE = 'tow.mcap'
STAMPS = (0, 1, 10**9, 2 * 10**9, 5 * 10**9, 2**31 * 10**9, 2**63 - 1)


@st.composite
def tows(draw: DrawFn) -> bytes:
    """A bag as it is written here, with messages of any content on the instruments' topics."""
    readings: list[tuple[str, Any, int]] = []
    for _ in range(draw(st.integers(0, 12))):
        topic = draw(st.sampled_from(SAMPLE_TOPICS))
        readings.append((topic, draw(values(TOPICS[topic].type)), draw(st.sampled_from(STAMPS))))
    with TemporaryDirectory() as folder:
        with BagWriter(Path(folder, 'bag')) as bag:
            for topic, message, stamp in readings:
                bag.write(absolute(topic), message.__msgtype__, serialize(message), stamp)
        (file,) = Path(folder, 'bag').glob('*.mcap')
        return file.read_bytes()


def read_windows(given: Path, results: Path) -> None:
    """Find the steady windows of a bag."""
    read_tow(BagTask(given / FILE, gear(), 'trawl'))


TARGETS = (
    Target(
        name='tow',
        inputs=one_file(FILE, st.one_of(tows(), tows(), mutated(tows()))),
        read=read_windows,
        examples=30,
    ),
)
