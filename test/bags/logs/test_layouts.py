"""Tables of other loggers: clocks, separators, decimal commas, long tables, rows left out."""

import math
from datetime import UTC, datetime

import pytest

from trawl_ros.bags.logs.import_log import NO_READING, import_log
from trawl_ros.bags.logs.layout import parse_degrees
from trawl_ros.bags.reader import Bag
from trawl_ros.core.errors import LogError
from trawl_ros.messages.from_messages import to_sample

PRESSURE = 'topics: {sonar/pressure: {fields: {pressure: {column: p, unit: bar}}}}\n'
AT = int(datetime(2026, 8, 1, 18, 38, 51, tzinfo=UTC).timestamp()) * 10**9


@pytest.fixture
def run(tmp_path):
    """Import a log given as text or bytes; gives (what was said, samples by topic)."""

    def run(log, mapping, encoding='utf-8', **options):
        data = log if isinstance(log, bytes) else log.encode(encoding)
        (tmp_path / 'log.csv').write_bytes(data)
        (tmp_path / 'mapping.yaml').write_text(mapping)
        bag = tmp_path / f'bag_{len(list(tmp_path.glob("bag_*")))}'
        said = import_log(tmp_path / 'log.csv', tmp_path / 'mapping.yaml', bag, **options)
        found = {}
        for received in Bag(bag).messages():
            topic = received.topic.removeprefix('/trawl/')
            found.setdefault(topic, []).append(to_sample(topic, received.message))
        return said, found

    return run


def stamps(found, topic='sonar/pressure'):
    return [sample.stamp for sample in found[topic]]


@pytest.mark.parametrize(
    ('clock', 'time'),
    [
        ('{columns: [t], format: seconds}', '1785609531'),
        ('{columns: [t], format: milliseconds}', '1785609531000'),
        ('{columns: [t], format: microseconds}', '1785609531000000'),
        ('{columns: [t], format: nanoseconds}', '1785609531000000000'),
        ('{columns: [t], format: iso}', '2026-08-01T18:38:51Z'),
        ('{columns: [t], format: iso}', '2026-08-01 20:38:51.000+02:00'),
        ('{columns: [t], format: iso, utc_offset_h: -8}', '20260801T103851'),
        ('{columns: [t], format: iso, zone: America/Anchorage}', '2026-08-01 10:38:51'),
        ("{columns: [t], format: '%d.%m.%y %H:%M:%S', zone: Europe/Oslo}", '01.08.26 20:38:51'),
        ("{columns: [t], format: '%Y %j %H:%M:%S'}", '2026 213 18:38:51'),
        ("{columns: [t], format: '%m/%d/%Y %I:%M:%S %p'}", '08/01/2026 06:38:51 PM'),
        ('{columns: [t], format: day of year, year: 2026}', '213.77697916666666666666'),
        ('{columns: [t], format: excel days}', '46235.77697916666666666666'),
        ("{columns: [t], format: elapsed seconds, start: '2026-08-01T18:00:00Z'}", '2331'),
        ("{columns: [t], format: elapsed minutes, start: '2026-08-01 18:00:00'}", '38.85'),
        ("{columns: [t], format: 'elapsed hh:mm:ss', start: '2026-08-01 00:00:00'}", '18:38:51'),
        ("{columns: [t], format: '%H:%M:%S', date: 2026-08-01}", '18:38:51'),
        ('{columns: [t], format: seconds, add_s: -9}', '1785609540'),
    ],
)
def test_clocks(run, clock, time):
    _, found = run(f't,p\n{time},13.5\n', f'clock: {clock}\n{PRESSURE}')
    (stamp,) = stamps(found)
    assert stamp == pytest.approx(AT, abs=1000), 'within a microsecond'


def test_fractions_of_iso_times_keep_their_nanoseconds(run):
    _, found = run(
        't,p\n2026-08-01T18:38:51.123456789Z,13.5\n',
        'clock: {columns: [t], format: iso}\n' + PRESSURE,
    )
    assert stamps(found) == [AT + 123_456_789]


def test_the_time_of_day_goes_on_over_midnight(run):
    log = 't,p\n23:59:59,1\n00:00:01,2\n00:00:03,3\n'
    clock = "clock: {columns: [t], format: '%H:%M:%S', date: 2026-07-31}\n"
    _, found = run(log, clock + PRESSURE)
    first, second, third = stamps(found)
    assert (second - first, third - first) == (2 * 10**9, 4 * 10**9)


def test_a_clock_time_that_a_zone_had_twice_is_refused(run):
    log = 't,p\n2026-10-25 02:30:00,1\n'
    with pytest.raises(LogError, match=r'Europe/Oslo.*utc_offset_h'):
        run(log, 'clock: {columns: [t], format: iso, zone: Europe/Oslo}\n' + PRESSURE)


def test_a_topic_may_have_a_clock_of_its_own(run):
    log = 't,p,t2,spread\n1785609531,13.5,1785609528,80\n1785609532,13.6,,\n'
    mapping = """\
clock: {columns: [t], format: seconds}
topics:
  sonar/pressure: {fields: {pressure: {column: p, unit: bar}}}
  door/spread:
    clock: {columns: [t2], format: seconds}
    fields: {distance: {column: spread, unit: m}}
    min_range: {value: 1, unit: m}
    max_range: {value: 400, unit: m}
"""
    _, found = run(log, mapping)
    assert stamps(found) == [AT, AT + 10**9]
    assert stamps(found, 'door/spread') == [AT - 3 * 10**9]


@pytest.mark.parametrize(
    ('clock', 'words'),
    [
        ('{columns: [t], format: elapsed seconds}', 'clock.*start: missing'),
        ('{columns: [t], format: day of year}', 'year: missing'),
        ("{columns: [t], format: '%H:%M:%S'}", 'date: missing'),
        ('{columns: [t], format: seconds, year: 2026}', 'year: given, expected none'),
        ('{columns: [t], format: iso, zone: Oslo}', "zone: found 'Oslo'"),
        ('{columns: [t], format: iso, zone: UTC, utc_offset_h: 1}', 'zone: .*utc_offset_h'),
        ('{columns: [t], format: sekunden}', "format: found 'sekunden'"),
        ("{columns: [t], format: '%Y%Y'}", "format: found '%Y%Y'"),
        ('{columns: [t], format: elapsed hours, start: noon}', "start: found 'noon'"),
    ],
)
def test_clocks_that_make_no_sense_are_refused(run, clock, words):
    with pytest.raises(LogError, match=words):
        run('t,p\n1,1\n', f'clock: {clock}\n{PRESSURE}')


GERMAN = """\
Fangreise 12; Kutter
# nur zur Probe
Zeit;Druck [bar];Länge
s;bar;Fd
1785609531;13,5;125,5
# Pause
1785609532;13,6;-999
"""
GERMAN_MAPPING = """\
clock: {columns: [Zeit], format: seconds}
layout:
  {encoding: cp1252, separator: ';', decimal: ',', skip_lines: 1, skip_after_names: 1, comment: '#'}
missing: ['', '-999,00']
topics:
  sonar/pressure: {fields: {pressure: {column: 'Druck [bar]', unit: bar}}}
  winch/joint_states: {fields: {port_length: {column: Länge, unit: fathom}}}
"""


def test_semicolons_decimal_commas_units_comments_and_another_encoding(run):
    said, found = run(GERMAN, GERMAN_MAPPING, encoding='cp1252')
    assert [sample.pressure for sample in found['sonar/pressure']] == pytest.approx(
        [13.5e5, 13.6e5]
    )
    (winch,) = found['winch/joint_states']
    assert winch.lengths[0] == pytest.approx(125.5 * 1.8288)
    assert said.rows == 2


@pytest.mark.parametrize(
    ('old', 'new', 'words'),
    [
        ('13,6', 'viel', r"line 7, column 'Druck \[bar\]'.*'viel'"),
        ('13,5', '13.5', r"line \d, column 'Druck \[bar\]'.*'13\.5'"),
    ],
    ids=['no number', 'a point'],
)
def test_errors_name_the_line_of_the_file_not_that_of_the_table(run, old, new, words):
    with pytest.raises(LogError, match=words):
        run(GERMAN.replace(old, new), GERMAN_MAPPING, encoding='cp1252')


@pytest.mark.parametrize(
    ('layout', 'log', 'encoding'),
    [
        ('separator: tab', 't\tp\n1785609531\t13.5\n', 'utf-8'),
        ('separator: blanks', '  t     p\n1785609531   13.5\n', 'utf-8'),
        ("separator: '|'", 't|p\n1785609531|13.5\n', 'utf-8'),
        ('names: [t, x, p]', '1785609531,7,13.5\n', 'utf-8'),
        ('encoding: utf-16', 't,p\r\n1785609531,13.5\r\n', 'utf-16'),
    ],
)
def test_separators_names_and_encodings_are_as_the_mapping_says(run, layout, log, encoding):
    mapping = f'clock: {{columns: [t], format: seconds}}\nlayout: {{{layout}}}\n'
    _, found = run(log, mapping + PRESSURE, encoding=encoding)
    assert stamps(found) == [AT]


LONG = """\
when,sensor,value,unit
1785609531,DepthPort,50.0,m
1785609531,PitchPort,-2.5,deg
1785609531,RollPort,13.0,deg
1785609541,PitchPort,-3.5,deg
1785609541,Battery,12.1,V
1785609551,PitchPort,-3.6,deg
1785609551,RollPort,12.0,deg
"""
LONG_MAPPING = """\
clock: {columns: [when], format: seconds}
layout: {long: {name: sensor, value: value}}
water: {density_kg_m3: 1025.0}
topics:
  door/port/pressure: {fields: {depth: {column: DepthPort, unit: m}}}
  door/port/attitude:
    fields:
      pitch: {column: PitchPort, unit: deg, scale: -1}
      roll: {column: RollPort, unit: deg}
"""


def test_a_long_table_is_put_together_by_instant(run):
    said, found = run(LONG, LONG_MAPPING)
    assert stamps(found, 'door/port/pressure') == [AT]
    assert stamps(found, 'door/port/attitude') == [AT, AT + 20 * 10**9]
    assert math.degrees(found['door/port/attitude'][1].pitch) == pytest.approx(3.6)
    assert said.rows == 3
    assert said.left_out == {NO_READING: 1}


def test_a_long_table_without_a_name_that_is_wanted_is_refused(run):
    with pytest.raises(LogError, match=r"'DepthPort' in column 'sensor' .* Battery"):
        run(LONG.replace('DepthPort', 'DepthStbd'), LONG_MAPPING)


def test_rows_can_be_picked_and_those_left_out_are_counted(run):
    mapping = 'clock: {columns: [t], format: seconds}\nonly: {state: [towing, EQ]}\n' + PRESSURE
    said, found = run('t,p,state\n1,1,towing\n2,2,shooting\n3,3,EQ\n4,,EQ\n', mapping)
    assert stamps(found) == [10**9, 3 * 10**9]
    assert said.left_out.pop(NO_READING) == 1
    (reason,) = said.left_out
    assert "column 'state'" in reason
    assert said.left_out[reason] == 1


def test_rows_that_make_no_sense_are_left_out_and_counted_where_that_is_asked_for(run):
    log = 't,p\n1,1\nx,2\n3,much\n4,4,4\n5,5\n'
    mapping = 'clock: {columns: [t], format: seconds}\n' + PRESSURE
    with pytest.raises(LogError, match="line 3, column 't': found 'x'"):
        run(log, mapping)
    said, found = run(log, mapping, leave_out=True)
    assert stamps(found) == [10**9, 5 * 10**9]
    assert list(said.left_out.values()) == [1, 1, 1]
    for part in ("column 't'", "column 'p'", 'number of cells'):
        assert part in ' '.join(said.left_out)


def test_a_reading_that_the_logger_repeats_is_one_reading(run):
    log = 't,p,q\n1,1,5\n2,1,6\n3,2,7\n'
    mapping = """\
clock: {columns: [t], format: seconds}
topics:
  sonar/pressure: {changes_only: true, fields: {pressure: {column: p, unit: bar}}}
  door/port/pressure: {fields: {pressure: {column: q, unit: bar}}}
"""
    _, found = run(log, mapping)
    assert stamps(found) == [10**9, 3 * 10**9]
    assert len(found['door/port/pressure']) == 3


@pytest.mark.parametrize(
    ('unit', 'topic', 'field', 'si'),
    [
        ('ft', 'winch/joint_states', 'port_length', 0.3048),
        ('fathom', 'winch/joint_states', 'port_length', 1.8288),
        ('tf', 'winch/joint_states', 'port_tension', 9806.65),
        ('short_tf', 'winch/joint_states', 'port_tension', 2000 * 0.45359237 * 9.80665),
        ('long_tf', 'winch/joint_states', 'port_tension', 2240 * 0.45359237 * 9.80665),
        ('fathom/min', 'winch/joint_states', 'port_speed', 1.8288 / 60),
        ('bar', 'sonar/pressure', 'pressure', 1e5),
        ('dbar', 'sonar/pressure', 'pressure', 1e4),
        ('psi', 'sonar/pressure', 'pressure', 0.45359237 * 9.80665 / 0.0254**2),
        ('kn', 'vessel/velocity_water', 'forward', 1852 / 3600),
    ],
)
def test_units(run, unit, topic, field, si):
    mapping = (
        'clock: {columns: [t], format: seconds}\n'
        f'topics: {{{topic}: {{fields: {{{field}: {{column: p, unit: {unit}}}}}}}}}\n'
    )
    _, found = run('t,p\n1,2\n', mapping)
    (sample,) = found[topic]
    value = {
        'port_length': lambda: sample.lengths[0],
        'port_speed': lambda: sample.speeds[0],
        'port_tension': lambda: sample.tensions[0],
        'pressure': lambda: sample.pressure,
        'forward': lambda: sample.velocity[0],
    }[field]()
    assert value == pytest.approx(2 * si, rel=1e-12)


@pytest.mark.parametrize(
    ('text', 'degrees'),
    [
        ('57 30.5 N', 57 + 30.5 / 60),
        ("57°30.5'N", 57 + 30.5 / 60),
        ('N57 30.500', 57 + 30.5 / 60),
        ('152-15.25W'.replace('-', ' '), -152 - 15.25 / 60),
        ('-152 15.25', -152 - 15.25 / 60),
        ('5730.5', 57 + 30.5 / 60),
        ('57°30\'30"S', -57.508333333333333),
        ('0030.0', 0.5),
    ],
)
def test_degrees_and_minutes(text, degrees):
    assert parse_degrees(text) == pytest.approx(degrees, abs=1e-12)


@pytest.mark.parametrize('text', ['57', 'N', '57 61.0', '57 30 N W', '5 7 8 9', 'north', '57 x'])
def test_what_are_no_degrees_and_minutes_is_refused(text):
    if text == '57':
        assert parse_degrees(text) == pytest.approx(57 / 60), 'packed, as in NMEA 0183'
        return
    with pytest.raises(ValueError, match='degrees and minutes'):
        parse_degrees(text)


def test_positions_in_degrees_and_minutes_with_a_column_for_the_hemisphere(run):
    log = 't,lat,ns,lon,ew\n1,5730.5,N,15215.25,W\n'
    mapping = """\
clock: {columns: [t], format: seconds}
topics:
  vessel/fix:
    fields:
      latitude: {column: lat, unit: deg_min, hemisphere: ns}
      longitude: {column: lon, unit: deg_min, hemisphere: ew}
"""
    _, found = run(log, mapping)
    (fix,) = found['vessel/fix']
    assert (fix.latitude, fix.longitude) == pytest.approx((57 + 30.5 / 60, -152 - 15.25 / 60))
    with pytest.raises(LogError, match="column 'ew': found 'X'"):
        run(log.replace('W', 'X'), mapping)


def test_the_depth_of_an_echo_sounder(run):
    mapping = """\
clock: {columns: [t], format: seconds}
topics:
  vessel/echo_sounder/depth:
    fields: {distance: {column: p, unit: fathom}}
    min_range: {value: 0.5, unit: m}
    max_range: {value: 2000, unit: m}
"""
    _, found = run('t,p\n1,50\n', mapping)
    assert found['vessel/echo_sounder/depth'][0].distance == pytest.approx(91.44)


@pytest.mark.parametrize(
    ('old', 'new', 'words'),
    [
        ('encoding: cp1252', 'encoding: ebcdic-x', "encoding: found 'ebcdic-x'"),
        ("separator: ';'", "separator: ';;'", "separator: found ';;'"),
        ("separator: ';'", "separator: ','", "separator: found ','"),
        ("decimal: ','", "decimal: ' '", 'decimal'),
        ('unit: fathom}', 'unit: fathom, hemisphere: x}', 'hemisphere: given'),
    ],
)
def test_layouts_that_make_no_sense_are_refused(run, old, new, words):
    assert old in GERMAN_MAPPING
    with pytest.raises(LogError, match=words):
        run(GERMAN, GERMAN_MAPPING.replace(old, new), encoding='cp1252')


def test_a_line_without_end_takes_no_memory(run):
    mapping = 'clock: {columns: [t], format: seconds}\n' + PRESSURE
    with pytest.raises(LogError, match=r'line 2 .*1000000'):
        run('t,p\n' + '1' * 1_000_100, mapping)


def test_blocks_of_nuls_in_a_table_are_no_hindrance(tmp_path):
    text = b's,depth\n0,61.5\n' + b'\0' * 2_500_000 + b'1,61.7\n2,61\0\0.9\n'
    (tmp_path / 'log.csv').write_bytes(text)
    (tmp_path / 'log.yaml').write_text(
        "clock: {columns: [s], format: elapsed seconds, start: '2026-08-01 12:00:00'}\n"
        'water: {density_kg_m3: 1025.0}\n'
        'topics: {door/port/pressure: {fields: {depth: {column: depth, unit: m}}}}\n'
    )
    done = import_log(tmp_path / 'log.csv', tmp_path / 'log.yaml', tmp_path / 'bag')
    assert (done.rows, dict(done.left_out)) == (3, {})
