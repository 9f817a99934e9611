"""Bag to sentences to bag: each reading within half a step, at its time, for every system."""

import itertools
import math
from pathlib import Path

import numpy as np
import pytest

from trawl_ros.bags.logs.import_log import import_log
from trawl_ros.bags.samples import SampleStream
from trawl_ros.bags.sentence_log import write_sentence_log
from trawl_ros.bags.writer import BagWriter
from trawl_ros.core.errors import BagError
from trawl_ros.core.time import SECOND
from trawl_ros.messages.cdr import serialize
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.records.fields import FIELDS, WaterColumn, fields_of_sample
from trawl_ros.records.samples import RangeSample
from trawl_ros.records.topics import absolute
from trawl_ros.sentences.framing import framed, tag_block
from trawl_ros.sentences.table import load_table, packaged_systems

SEA_TRIAL = Path(__file__).parents[2] / 'bags/sea_trial'
WATER = WaterColumn(density_kg_m3=1025.0)
DRAWN = ('bottom', 'depth', 'opening_height')
SYSTEMS = [name for name in packaged_systems() if name != 'set_points']
MAPPING = """
nmea:
  {date}
  topics:
    vessel/fix: {{sentences: [GGA]}}
    vessel/velocity_ground: {{sentences: [VTG]}}
    vessel/velocity_water: {{sentences: [VBW]}}
    vessel/heading: {{sentences: [HDT]}}
    vessel/echo_sounder/depth: {{sentences: [DPT], min_range: {{value: 1, unit: m}},
      max_range: {{value: 2000, unit: m}}}}
  systems: [{systems}]
"""


@pytest.fixture(scope='module')
def bag(tmp_path_factory):
    """Three minutes of the sea trial, with a seabed and heights of the net drawn for them."""
    stretch = itertools.takewhile(
        lambda pair: pair[1].stamp < 180 * SECOND, iter(SampleStream([SEA_TRIAL], 'trawl'))
    )
    samples = [
        sample
        for _, sample in stretch
        if fields_of_sample(sample) and getattr(sample, 'what', '') not in DRAWN
    ]
    draws = np.random.default_rng(7)
    for second in range(180):
        for what in DRAWN:
            distance = float(draws.uniform(90.0, 110.0))
            samples.append(RangeSample(second * SECOND, what, distance, 0.1, 0.5, 2000.0))
    path = tmp_path_factory.mktemp('bags') / 'short'
    with BagWriter(path) as writer:
        for sample in sorted(samples, key=lambda sample: sample.stamp):
            topic, message = sample_message(sample)
            data = serialize(message)
            writer.write(absolute(topic), message.__msgtype__, data, sample.stamp)
    return path


def fields_in(bag):
    """Fields of each topic by stamp."""
    found = {}
    for _, sample in SampleStream([bag], 'trawl'):
        topic, fields = fields_of_sample(sample, WATER)
        assert (topic, sample.stamp) not in found
        found[topic, sample.stamp] = fields
    return found


@pytest.fixture(scope='module')
def there(bag):
    return fields_in(bag)


@pytest.mark.parametrize('system', SYSTEMS)
def test_a_bag_comes_back_from_sentences(system, bag, there, tmp_path):
    table = load_table(system)
    log, mapping = tmp_path / 'log.nmea', tmp_path / 'mapping.yaml'
    write_sentence_log(bag, [table], log, water=WATER, every_reading=True)
    mapping.write_text(MAPPING.format(date='', systems='' if system == 'ship' else system))
    done = import_log(log, mapping, tmp_path / 'back')
    assert done.notes == ()
    back = fields_in(tmp_path / 'back')
    steps = {
        field.target: field.step
        for row in table.sentences.values()
        for field in row.fields
        if field.reading and not row.form
    }
    compared = dict.fromkeys(steps, 0)
    for (topic, stamp), fields in there.items():
        for name, value in fields.items():
            if (topic, name) not in steps or math.isnan(value):
                continue
            off = back[topic, stamp][name] - value
            if FIELDS[topic][name] == 'angle':
                off = math.remainder(off, 2 * math.pi)
            # A distance is a number of 32 bits in its message.
            bound = 0.5 * steps[topic, name] * (1 + 1e-6) + 1e-5 * (topic.count('/bottom') + 1)
            assert abs(off) <= bound, (topic, name, stamp)
            compared[topic, name] += 1
    assert min(compared.values()) > 10, compared


def test_nothing_to_say_leaves_no_file(bag, tmp_path):
    with pytest.raises(BagError, match=r'no such bag|not a bag'):
        write_sentence_log(tmp_path / 'none', [load_table('ship')], tmp_path / 'a', water=WATER)
    with pytest.raises(BagError, match='exists already'):
        write_sentence_log(bag, [load_table('ship')], tmp_path, water=WATER)


def imported(tmp_path, lines, systems, date=''):
    log, mapping = tmp_path / 'log.nmea', tmp_path / 'mapping.yaml'
    log.write_bytes(b'\r\n'.join(lines))
    mapping.write_text(MAPPING.format(date=date, systems=systems))
    done = import_log(log, mapping, tmp_path / 'back')
    return done, fields_in(tmp_path / 'back')


def checked(body):
    return framed('$', body, checksum=True).encode()


def test_clocks_that_differ_are_told_and_the_ships_is_used(tmp_path):
    lines = []
    for second in range(10):
        lines.append(checked(f'GPZDA,1200{second:02d}.00,01,08,2026,00,00'))
        lines.append(checked(f'PSCMSM2,1159{second + 50:02d}.00,A,DVTLAM,1,S,84.{second},15'))
    done, found = imported(tmp_path, lines, 'scanmar')
    assert done.notes == ('the clock of scanmar is 10.0 s behind the stamps',)
    first = min(stamp for _, stamp in found)
    assert found['door/spread', first]['distance'] == pytest.approx(84.0)
    assert first % (86_400 * SECOND) == 12 * 3600 * SECOND


def test_times_of_day_alone_go_over_midnight_from_the_date_of_the_mapping(tmp_path):
    lines = [
        checked(f'PSCMSM2,{time},A,DVTLAM,1,S,84.5,15')
        for time in ('235958.00', '235959.00', '000000.50')
    ]
    _, found = imported(tmp_path, lines, 'scanmar', 'date: 2026-08-01')
    stamps = sorted(stamp for _, stamp in found)
    assert np.diff(stamps).tolist() == [SECOND, 3 * SECOND // 2]


def test_sentences_with_their_own_date_need_no_clock_of_the_ship(tmp_path):
    body = 'PSIMTV80,103851,260801,,,,,,,,,,,,,01,a01,a02,84.50,10,'
    _, found = imported(tmp_path, [checked(body)], 'simrad')
    (((topic, _), fields),) = found.items()
    assert (topic, fields) == ('door/spread', {'distance': pytest.approx(84.5)})


def test_of_two_systems_that_tell_a_topic_the_first_named_is_used(tmp_path):
    lines = [
        checked('GPZDA,120000.00,01,08,2026,00,00'),
        b'@IITDS,80.0,M',
        checked('MPMSD,T,PD,23,XST,m,84.50'),
        b'@IITDS,80.0,f',
        b'@IITDX,80.0,M',
    ]
    done, found = imported(tmp_path, lines, 'marport, simrad_iti')
    assert [fields['distance'] for fields in found.values()] == [pytest.approx(84.5)]
    assert done.left_out == {
        'simrad_iti for door/spread, which marport tells': 1,
        "sentence @IITDS: field 2 is 'f', expected 'M'": 1,
        'sentence @IITDX, which is in no table': 1,
    }


def test_times_of_a_recorder_and_of_tag_blocks_are_those_of_gear_too(tmp_path):
    spread = checked('MPMSD,T,PD,23,XST,m,84.50')
    tag = tag_block(1_785_580_732_000 * 1_000_000).encode()
    lines = [b'2026-08-01T10:38:51.250Z,' + spread, b'2026-08-01T10:38:52.250Z,@IITDS,80.0,M']
    recorder = 'time: recorder\n  recorder: {format: iso}'
    done, found = imported(tmp_path, lines, 'marport', recorder)
    ((_, stamp),) = found
    assert stamp == 1_785_580_731_250 * 1_000_000
    assert done.left_out == {'sentence @IITDS, which is in no table': 1}
    (tmp_path / 'tagged').mkdir()
    recorder = 'time: recorder\n  recorder: {format: milliseconds}'
    _, found = imported(tmp_path / 'tagged', [tag + spread], 'marport', recorder)
    assert [stamp for _, stamp in found] == [1_785_580_732_000 * 1_000_000]
