"""Samples of a sea trial come back from every system's sentences, within a step of each field."""

import itertools
import math
from pathlib import Path

import numpy as np
import pytest

from trawl_ros.bags.samples import SampleStream
from trawl_ros.core.time import SECOND
from trawl_ros.records.fields import FIELDS, WaterColumn, fields_of_sample
from trawl_ros.records.samples import RangeSample
from trawl_ros.sentences.assembly import SampleAssembly, samples_of
from trawl_ros.sentences.codec import SentenceReader
from trawl_ros.sentences.framing import parse_line
from trawl_ros.sentences.table import load_table, packaged_systems
from trawl_ros.sentences.writer import SentenceWriter

BAG = Path(__file__).parents[2] / 'bags/sea_trial'
WATER = WaterColumn(density_kg_m3=1025.0)
TURN = 2 * math.pi


@pytest.fixture(scope='module')
def samples():
    """Six minutes in which warps change, with a seabed and heights of the net drawn for them."""
    stream = SampleStream([BAG], 'trawl')
    stretch = itertools.takewhile(lambda pair: pair[1].stamp < 2000 * SECOND, iter(stream))
    found = [
        sample
        for _, sample in stretch
        if sample.stamp >= 1640 * SECOND and getattr(sample, 'what', '') != 'opening_height'
    ]
    draws = np.random.default_rng(23)
    for what, depth in (('bottom', 140.0), ('depth', 310.0), ('opening_height', 95.0)):
        for second in range(1640, 2000):
            distance = depth + float(draws.normal(0.0, 3.0))
            found.append(RangeSample(second * SECOND, what, distance, 0.1, 0.5, 2000.0))
    return sorted(found, key=lambda sample: sample.stamp)


def spoken(table, samples):
    """All sentences of samples with the stamps of these, in their order."""
    writer = SentenceWriter([table], WATER, every_reading=True)
    instants = itertools.groupby(samples, lambda sample: sample.stamp)
    return [(text, stamp) for stamp, together in instants for text in writer.write(*together)]


def steps(table):
    """Step of each reading, by topic and field, of the form that is written."""
    return {
        field.target: field.step
        for row in table.sentences.values()
        for field in row.fields
        if field.reading and not row.form
    }


@pytest.mark.parametrize('system', [one for one in packaged_systems() if one != 'set_points'])
def test_each_reading_comes_back_within_half_a_step_and_is_written_as_before(system, samples):
    table = load_table(system)
    reader = SentenceReader([table])
    texts = spoken(table, samples)
    assert all(len(text) <= 120 and text.isascii() for text, _ in texts)
    heard = [(reader.read(parse_line(text.encode())), stamp) for text, stamp in texts]
    back = samples_of(heard, SampleAssembly([table], WATER))
    found = {}
    for sample in back:
        topic, fields = fields_of_sample(sample, WATER)
        found.setdefault((topic, sample.stamp), []).append(fields)
    assert all(len(twice) == 1 for twice in found.values())
    compared = dict.fromkeys(steps(table), 0)
    for sample in samples:
        taken = fields_of_sample(sample, WATER)
        if taken is None or taken[0] not in {topic for topic, _ in compared}:
            continue
        topic, fields = taken
        for (told, name), step in steps(table).items():
            if told != topic or math.isnan(fields[name]):
                continue
            (there,) = found[topic, sample.stamp]
            off = there[name] - fields[name]
            if FIELDS[topic][name] == 'angle':
                off = math.remainder(off, TURN)
            assert abs(off) <= 0.5 * step * (1 + 1e-6) + 1e-9, (name, sample.stamp)
            compared[told, name] += 1
    assert min(compared.values()) > 30, compared
    # What says that there is no reading makes no sample, and is not said again.
    told = [
        text
        for (text, _), (item, _) in zip(texts, heard, strict=True)
        if not all(math.isnan(value) for value in item.readings.values())
    ]
    assert sorted(text for text, _ in spoken(table, back)) == sorted(told)
