"""Checkpoints of the identification: damaged archives, and whole ones that say other things."""

import json
import zipfile
from copy import deepcopy
from functools import cache
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from hypothesis import strategies as st
from hypothesis.strategies import DrawFn

from hostile.mutations import mutated
from hostile.target import Target, one_file
from trawl_ros.estimation.checkpoint.file import JSON, NUMBERS, load_checkpoint, save_checkpoint
from trawl_ros.estimation.from_gear import identification_for
from trawl_ros.estimation.pipeline import Identification
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.records.samples import WinchSample

FILE = 'state'
SAMPLES = tuple(
    WinchSample(second * 1_000_000_000, (200.0, 200.0), (0.0, 0.0), (1e5, 1e5))
    for second in range(20)
)
VALUES: tuple[Any, ...] = (
    *(None, True, 0, -1, 10**30, 1e999, '', 'x' * 5000, [], {}, [[]], {'same': 0}, {'same': -1}),
    *({'given': ''}, {'given': 'x'}, {'same': []}, {'number': 0, 'list': [{'same': 0}]}),
    *({'number': 0, 'dict': [[[], 1]]}, {'number': 3, 'object': 'os.system', 'has': {}}),
    *({'number': 1, 'array': '<f8', 'shape': [2**40], 'at': 0}, {'number': 1, 'array': '|O'}),
    *(
        {'number': 1, 'array': '<f8', 'shape': [-1], 'at': -8},
        {'number': 1, 'deque': 5, 'most': -1},
    ),
    {'number': 1, 'object': 'trawl_ros.estimation.checkpoint.file.StateError', 'has': {}},
)


@cache
def gear() -> GearRecord:
    """The default gear."""
    return load_gear('kaifuha')


@cache
def fresh() -> Identification:
    """An identification that has heard nothing."""
    return identification_for(gear())


@cache
def sound() -> bytes:
    """A checkpoint after some readings."""
    identification = identification_for(gear())
    for sample in SAMPLES:
        identification.feed(sample)
    with TemporaryDirectory() as folder:
        save_checkpoint(Path(folder, FILE), identification, gear())
        return Path(folder, FILE).read_bytes()


def archive(record: bytes, numbers: bytes, packing: int) -> bytes:
    """An archive as a checkpoint is one."""
    made = BytesIO()
    with zipfile.ZipFile(made, 'w', packing) as file:
        file.writestr(JSON, record)
        file.writestr(NUMBERS, numbers)
    return made.getvalue()


@st.composite
def with_other_content(draw: DrawFn) -> bytes:
    """A checkpoint some values of which are others, with checksums that are right."""
    with zipfile.ZipFile(BytesIO(sound())) as file:
        record, numbers = json.loads(file.read(JSON)), file.read(NUMBERS)
    for _ in range(draw(st.integers(1, 3))):
        place: Any = record if draw(st.integers(0, 9)) == 0 else record['identification']
        while isinstance(place, dict | list) and place:
            keys = sorted(place) if isinstance(place, dict) else range(len(place))
            key = draw(st.sampled_from(list(keys)))
            below = place[key]
            if not isinstance(below, dict | list) or not below or draw(st.integers(0, 9)) == 0:
                place[key] = deepcopy(draw(st.sampled_from(VALUES)))
                break
            place = below
        if not isinstance(record['identification'], dict | list):
            break
    packing = draw(st.sampled_from((zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)))
    numbers = draw(st.sampled_from((numbers, numbers, b'', numbers[:-3], b'\xff' * len(numbers))))
    return archive(json.dumps(record).encode(), numbers, packing)


def damaged() -> st.SearchStrategy[bytes]:
    """Archives with flipped bits, and such whose JSON is none."""
    deep = st.sampled_from((b'[', b'{"a":', b'{"what": "state of an identification", "format": '))
    texts = st.one_of(deep.map(lambda part: part * 100_000), st.binary(max_size=64))
    return st.one_of(
        mutated(st.builds(sound)),
        st.tuples(texts, st.binary(max_size=16), st.just(zipfile.ZIP_DEFLATED)).map(
            lambda made: archive(*made)
        ),
    )


def read_state(given: Path, results: Path) -> None:
    """Resume from a checkpoint."""
    load_checkpoint(given / FILE, fresh(), gear())


TARGETS = (
    Target(
        name='checkpoint',
        inputs=one_file(FILE, st.one_of(with_other_content(), with_other_content(), damaged())),
        read=read_state,
        examples=60,
    ),
)
