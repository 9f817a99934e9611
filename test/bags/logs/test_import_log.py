"""CSV logs become bags by a mapping; mistakes in either are named with line and column."""

import math
from datetime import UTC, datetime
from pathlib import Path

import pytest
from mcap.reader import make_reader

from trawl_ros.bags.logs.import_log import import_log
from trawl_ros.bags.reader import Bag
from trawl_ros.core.errors import BagError, LogError
from trawl_ros.core.limits import Limit
from trawl_ros.messages.from_messages import to_sample

ROOT = Path(__file__).parents[3]
HAUL_LOG = ROOT.parent / 'shared/data/noaa_trawlmetrics/gear_testing_2026_haul_log.csv'
HAUL_MAPPING = ROOT / 'config/logs/door_test_haul_log.yaml'

LOG = """\
Date,Time,Scope,Tension,Depth,Pitch,Roll,Spread,Speed,Course,Heading,Lat,Lon
2026-08-01,10:00:00,125,2.7,51.2,-2.7,13.0,80.5,3.9,90,180,57.5,-152.25
2026-08-01,10:01:00,150,,NaN,,5,,,,,,
2026-08-01,09:59:00,,2.0,,,,81,,,,,
"""

MAPPING = """\
clock: {columns: [Date, Time], format: '%Y-%m-%d %H:%M:%S', utc_offset_h: -8}
water: {density_kg_m3: 1025.0}
topics:
  winch/joint_states:
    fields:
      port_length: {column: Scope, unit: fathom}
      starboard_tension: {column: Tension, unit: tf}
  door/port/pressure:
    fields:
      depth: {column: Depth, unit: m}
    std: {value: 0.5, unit: m}
  door/port/attitude:
    fields:
      pitch: {column: Pitch, unit: deg, scale: -1}
      roll: {column: Roll, unit: deg}
  door/spread:
    fields:
      distance: {column: Spread, unit: m, offset: -2.5}
    min_range: {value: 5, unit: m}
    max_range: {value: 400, unit: m}
  vessel/velocity_water:
    fields:
      forward: {column: Speed, unit: kn}
  vessel/velocity_ground:
    fields:
      speed: {column: Speed, unit: kn}
      compass_course: {column: Course, unit: deg}
  vessel/heading:
    fields:
      compass_heading: {column: Heading, unit: deg}
    std: {value: 1, unit: deg}
  vessel/fix:
    fields:
      latitude: {column: Lat, unit: deg}
      longitude: {column: Lon, unit: deg}
    std: {value: 5, unit: m}
"""


@pytest.fixture
def run(tmp_path):
    """Import a log given as text; gives (what was said, samples by topic)."""

    def run(log=LOG, mapping=MAPPING):
        (tmp_path / 'log.csv').write_text(log)
        (tmp_path / 'mapping.yaml').write_text(mapping)
        bag = tmp_path / 'bag'
        said = import_log(tmp_path / 'log.csv', tmp_path / 'mapping.yaml', bag)
        return said, samples(bag)

    return run


def samples(path):
    found = {}
    for received in Bag(path).messages():
        topic = received.topic.removeprefix('/trawl/')
        found.setdefault(topic, []).append(to_sample(topic, received.message))
    return found


def seconds(*when):
    return int(datetime(*when, tzinfo=UTC).timestamp()) * 1_000_000_000


def test_units_and_clock_are_turned_into_si_and_utc(run):
    _, found = run()
    winch = found['winch/joint_states'][1]
    assert winch.stamp == seconds(2026, 8, 1, 18, 0, 0)
    assert winch.lengths[0] == pytest.approx(125 * 1.8288)
    assert winch.tensions[1] == pytest.approx(2.7 * 9806.65)


def test_what_a_winch_row_does_not_say_is_missing(run):
    _, found = run()
    winch = found['winch/joint_states'][1]
    assert math.isnan(winch.lengths[1])
    assert math.isnan(winch.tensions[0])
    assert math.isnan(winch.speeds[0])


def test_a_depth_becomes_an_absolute_pressure(run):
    _, found = run()
    (pressure,) = found['door/port/pressure']
    assert pressure.pressure == pytest.approx(101_325 + 1025 * 9.80665 * 51.2)
    assert pressure.std == pytest.approx(1025 * 9.80665 * 0.5)


def test_signs_and_offsets_are_applied(run):
    _, found = run()
    (attitude,) = found['door/port/attitude']
    assert math.degrees(attitude.pitch) == pytest.approx(2.7)
    assert math.degrees(attitude.roll) == pytest.approx(13.0)
    spreads = found['door/spread']
    assert [spread.distance for spread in spreads] == [78.5, 78.0]
    assert (spreads[0].min_range, spreads[0].max_range) == (5.0, 400.0)


def test_compass_angles_become_east_north_up(run):
    _, found = run()
    (ground,) = found['vessel/velocity_ground']
    (heading,) = found['vessel/heading']
    assert ground.velocity == pytest.approx([3.9 * 1852 / 3600, 0, 0]), 'due east'
    assert heading.heading == pytest.approx(-math.pi / 2), 'due south'
    assert heading.std == pytest.approx(math.radians(1))


def test_a_position_stays_in_degrees(run):
    _, found = run()
    (fix,) = found['vessel/fix']
    assert (fix.latitude, fix.longitude) == pytest.approx((57.5, -152.25))


def test_rows_without_a_reading_give_no_message(run):
    said, found = run()
    assert said.rows == 3
    assert said.counts['/trawl/winch/joint_states'] == 3
    assert said.counts['/trawl/door/port/pressure'] == 1
    assert said.counts['/trawl/door/port/attitude'] == 1, 'pitch and roll come together'
    assert {topic: len(entries) for topic, entries in found.items()} == {
        topic.removeprefix('/trawl/'): count for topic, count in said.counts.items()
    }


def test_rows_out_of_order_come_in_order_of_time(run):
    _, found = run()
    stamps = [sample.stamp for sample in found['winch/joint_states']]
    assert stamps == sorted(stamps)


def test_also_in_the_file_readings_stand_in_the_order_of_time(run, tmp_path):
    run()
    with (tmp_path / 'bag' / 'bag_0.mcap').open('rb') as stream:
        stored = make_reader(stream).iter_messages(log_time_order=False)
        stamps = [message.log_time for _, _, message in stored]
    assert stamps == sorted(stamps)


def test_seconds_keep_their_nanoseconds(run):
    log = 't,p\n1785600000.123456789,13.5\n'
    mapping = (
        'clock: {columns: [t], format: seconds}\n'
        'topics: {sonar/pressure: {fields: {pressure: {column: p, unit: bar}}}}\n'
    )
    _, found = run(log, mapping)
    (pressure,) = found['sonar/pressure']
    assert pressure.stamp == 1_785_600_000_123_456_789
    assert (pressure.pressure, pressure.std) == (1.35e6, 0.0)


def test_the_same_log_gives_the_same_bytes(tmp_path):
    for name in ('log.csv', 'mapping.yaml'):
        (tmp_path / name).write_text(LOG if name == 'log.csv' else MAPPING)
    for bag in ('one', 'two'):
        import_log(tmp_path / 'log.csv', tmp_path / 'mapping.yaml', tmp_path / bag)
    one, two = (tmp_path / bag / f'{bag}_0.mcap' for bag in ('one', 'two'))
    assert one.read_bytes() == two.read_bytes()


@pytest.mark.parametrize(
    ('old', 'new', 'words'),
    [
        ('2.0,,', '2_0,,', r"line 4, column 'Tension'.*'2_0'"),
        (',5,', ',five,', r"line 3, column 'Roll'.*'five'.*\(deg\)"),
        (',5,', ',inf,', r"line 3, column 'Roll'.*'inf'"),
        ('09:59:00', '9h59', r"line 4, column 'Date' and 'Time'.*'2026-08-01 9h59'"),
        ('2026-08-01,09', '1926-08-01,09', 'line 4, .*1926.*1970 to 2038'),
        ('Scope', 'Cable', r"no column 'Scope' \(wanted by topics\.winch/joint_states\)"),
        ('Lat,Lon', 'Lat,Lon,Depth', "column 'Depth'"),
        (',81,', ',81,,', 'line 4 .*14.*13'),
    ],
)
def test_mistakes_in_the_log_are_named_with_their_line(run, tmp_path, old, new, words):
    with pytest.raises(LogError, match=words) as caught:
        run(LOG.replace(old, new))
    assert str(caught.value).startswith(str(tmp_path / 'log.csv'))
    assert not (tmp_path / 'bag').exists()


@pytest.mark.parametrize('content', ['', 'Date,Time,Scope,Tension\n'])
def test_a_log_without_rows_or_columns_is_refused(run, content):
    with pytest.raises(LogError, match=r'log\.csv'):
        run(content)


def test_a_log_that_is_not_text_is_refused(tmp_path):
    (tmp_path / 'log.csv').write_bytes(b'\xff\xfa\x00\x01' * 10)
    (tmp_path / 'mapping.yaml').write_text(MAPPING)
    with pytest.raises(LogError, match='not CSV in UTF-8'):
        import_log(tmp_path / 'log.csv', tmp_path / 'mapping.yaml', tmp_path / 'bag')


def test_a_missing_log_is_named(tmp_path):
    (tmp_path / 'mapping.yaml').write_text(MAPPING)
    with pytest.raises(LogError, match=r'nothing\.csv: no such file'):
        import_log(tmp_path / 'nothing.csv', tmp_path / 'mapping.yaml', tmp_path / 'bag')


def test_a_log_without_any_reading_is_refused(run):
    with pytest.raises(LogError, match=r'log\.csv.*1 rows'):
        run(LOG.splitlines()[0] + '\n2026-08-01,10:00:00' + 11 * ',' + '\n')


@pytest.mark.parametrize(
    ('old', 'new', 'words'),
    [
        ('unit: fathom', 'unit: deg', r"port_length\.unit.*'deg'.*fathom"),
        ('unit: tf', 'unit: tons', "starboard_tension.unit: found 'tons', expected .* kN"),
        ('door/spread:', 'door/width:', 'topics.door/width: unknown topic'),
        ('port_length:', 'length:', r'fields\.length: .*port_length'),
        ('water: {density_kg_m3: 1025.0}', '', 'water: missing, expected density_kg_m3'),
        ('      roll: {column: Roll, unit: deg}\n', '', 'attitude.*pitch and roll'),
        ('value: 400', 'value: 4', 'max_range: found 4 m.*min_range'),
        ('std: {value: 5, unit: m}', 'std: {value: -5, unit: m}', 'std.value: found -5'),
        ('std: {value: 1, unit: deg}', 'std: {value: 1, unit: m}', "std.unit: found 'm'"),
        ('1025.0', '1.025', 'density_kg_m3: found 1.025'),
        ('utc_offset_h: -8', 'utc_offset_h: -800', 'utc_offset_h: found -800'),
        ('clock:', 'clocks:', 'clock'),
    ],
)
def test_mistakes_in_the_mapping_are_named_with_their_key(run, tmp_path, old, new, words):
    with pytest.raises(LogError, match=words) as caught:
        run(mapping=MAPPING.replace(old, new, 1))
    assert str(caught.value).startswith(str(tmp_path / 'mapping.yaml'))


def test_a_log_of_too_many_readings_is_refused_and_nothing_written(run, tmp_path, monkeypatch):
    limit = Limit(5, 'readings', 'a log')
    monkeypatch.setattr('trawl_ros.bags.logs.import_log.LOG_READINGS', limit)
    with pytest.raises(LogError, match=r'log\.csv: .*5 readings'):
        run()
    assert not (tmp_path / 'bag').exists()


def test_a_bag_that_exists_is_kept(run, tmp_path):
    (tmp_path / 'bag').mkdir()
    with pytest.raises(BagError, match='exists already'):
        run()


@pytest.mark.skipif(not HAUL_LOG.is_file(), reason=f'no measured data: {HAUL_LOG}')
def test_the_door_tests_at_sea_become_a_bag(tmp_path):
    said = import_log(HAUL_LOG, HAUL_MAPPING, tmp_path / 'haul')
    found = samples(tmp_path / 'haul')
    assert said.rows == 104
    assert {topic: len(entries) for topic, entries in found.items()} == {
        'winch/joint_states': 104,
        'door/port/pressure': 51,
        'door/port/attitude': 51,
        'door/starboard/pressure': 51,
        'door/starboard/attitude': 51,
    }
    winch, attitude = found['winch/joint_states'][0], found['door/starboard/attitude'][0]
    assert winch.stamp == attitude.stamp == seconds(2026, 8, 1, 18, 38, 51)
    assert winch.lengths == pytest.approx((228.6, 228.6))
    assert winch.tensions == pytest.approx((26_477.955, 26_477.955))
    assert math.degrees(attitude.pitch) == pytest.approx(3.7)
    assert math.degrees(attitude.roll) == pytest.approx(-5.5)
    depth = (found['door/starboard/pressure'][0].pressure - 101_325) / (1025 * 9.80665)
    assert depth == pytest.approx(50.2)


def test_the_mapping_for_the_door_tests_is_sound_without_the_data(tmp_path):
    log = (
        'Date_AKDT,Time_AKDT,Scope,Port Tension,Stbd Tension,Port_Door_Depth,Stbd_Door_Depth,'
        'Port_Door_Pitch,Stbd_Door_Pitch,Port_Door_Roll,Stbd_Door_Roll\n'
        '2026-08-01,10:38:51,125,2.7,2.7,51.2,50.2,-2.7,-3.7,13.0,-5.5\n'
    )
    (tmp_path / 'log.csv').write_text(log)
    said = import_log(tmp_path / 'log.csv', HAUL_MAPPING, tmp_path / 'bag')
    assert sum(said.counts.values()) == 5
