"""Logs of NMEA 0183 become bags: who says what, when it was so, and what is left out."""

import math
from datetime import UTC, datetime
from pathlib import Path

import pytest
from pynmeagps.nmeahelpers import calc_checksum

from trawl_ros.bags.logs.import_log import import_log
from trawl_ros.bags.reader import Bag
from trawl_ros.core.errors import LogError
from trawl_ros.messages.from_messages import to_sample
from trawl_ros.sentences.framing import NO_TEXT
from trawl_ros.sentences.log import UNDATED
from trawl_ros.sentences.log_times import spread_stamps

MAPPING = Path(__file__).parents[3] / 'config/logs/nmea.yaml'
KNOT = 1852 / 3600
SECOND = 1_000_000_000


def sentence(content):
    return f'${content}*{calc_checksum(content)}'


def at(*when):
    return int(datetime(2026, 8, 1, *when, tzinfo=UTC).timestamp()) * SECOND


RMC = 'GPRMC,103851.00,A,5730.5000,N,15215.2500,W,3.9,090.0,010826,,,A'
LOG = [
    RMC,
    'GPGGA,103851.00,5730.5000,N,15215.2500,W,1,09,0.9,12.0,M,,M,,',
    'GPVTG,090.0,T,,M,3.9,N,7.2,K,A',
    'HEHDT,180.0,T',
    'VWVHW,180.0,T,,M,4.1,N,7.6,K',
    'SDDPT,85.2,-3.0,',
    'GPGSV,1,1,00',
    'GPGGA,103852.00,5730.5000,N,15215.2600,W,1,09,0.9,12.0,M,,M,,',
]


@pytest.fixture
def run(tmp_path):
    """Import sentences given without checksum; gives (what was said, samples by topic)."""

    def run(contents=LOG, mapping=None, lines=None, **options):
        lines = [sentence(content) for content in contents] if lines is None else lines
        log = tmp_path / 'log.nmea'
        log.write_bytes('\r\n'.join([*lines, '']).encode('latin-1'))
        path = MAPPING
        if mapping is not None:
            path = tmp_path / 'mapping.yaml'
            path.write_text(mapping)
        said = import_log(log, path, tmp_path / 'bag', **options)
        found = {}
        for received in Bag(tmp_path / 'bag').messages():
            topic = received.topic.removeprefix('/trawl/')
            found.setdefault(topic, []).append(to_sample(topic, received.message))
        return said, found

    return run


def changed(old, new):
    text = MAPPING.read_text()
    assert old in text
    return text.replace(old, new)


def test_position_speed_heading_and_depth_come_out_in_si_and_east_north_up(run):
    said, found = run()
    fix, later = found['vessel/fix']
    assert (fix.latitude, fix.longitude) == pytest.approx((57 + 30.5 / 60, -152 - 15.25 / 60))
    assert (fix.stamp, later.stamp) == (at(10, 38, 51), at(10, 38, 52))
    assert fix.std == 5.0
    (ground,) = found['vessel/velocity_ground']
    assert ground.velocity == pytest.approx([3.9 * KNOT, 0, 0]), 'course 090 is due east'
    (water,) = found['vessel/velocity_water']
    assert water.velocity == pytest.approx([4.1 * KNOT, 0, 0])
    (heading,) = found['vessel/heading']
    assert heading.heading == pytest.approx(-math.pi / 2), 'heading 180 is due south'
    assert heading.std == pytest.approx(math.radians(1))
    (depth,) = found['vessel/echo_sounder/depth']
    assert depth.distance == pytest.approx(82.2), 'the keel is 3 m below the transducer'
    assert said.rows == 8


def counted(said, *names):
    """Count what was left out by a reason that has each of these names."""
    return sum(n for why, n in said.left_out.items() if all(name in why for name in names))


def test_one_kind_of_sentence_tells_a_topic_and_the_others_are_counted(run):
    said, found = run()
    assert len(found['vessel/fix']) == 2
    assert counted(said, 'RMC', 'vessel/fix', 'GGA') == 1
    assert counted(said, 'RMC', 'vessel/velocity_ground', 'VTG') == 1
    assert counted(said, '$GPGSV') == 1


def test_without_the_better_sentence_the_next_one_tells(run):
    _, found = run([RMC, RMC.replace('103851', '103853')])
    assert [fix.stamp for fix in found['vessel/fix']] == [at(10, 38, 51), at(10, 38, 53)]
    assert found['vessel/velocity_ground'][0].velocity == pytest.approx([3.9 * KNOT, 0, 0])


def test_a_damaged_sentence_gives_nothing_and_is_counted(run):
    lines = [sentence(content) for content in LOG]
    lines[3] = lines[3].replace('180.0', '130.0')
    lines[5] = lines[5].partition('*')[0]
    lines[6] = 'noise from the \xff line'
    said, found = run(lines=lines)
    assert 'vessel/heading' not in found
    assert 'vessel/echo_sounder/depth' not in found
    assert counted(said, 'checksum is wrong') == 1
    assert said.left_out['sentence $SDDPT: no checksum'] == 1
    assert said.left_out[NO_TEXT] == 1


def test_a_sentence_cut_short_by_the_next_costs_only_itself(run):
    lines = [sentence(content) for content in LOG]
    lines[3] = lines[2][:20] + lines[3]
    _, found = run(lines=lines)
    assert len(found['vessel/heading']) == 1


def test_sentences_without_checksum_are_used_where_the_mapping_says_so(run):
    lines = [f'${content}' for content in LOG]
    mapping = changed('  time: sentences', '  need_checksum: false\n  time: sentences')
    _, found = run(lines=lines, mapping=mapping)
    assert len(found['vessel/fix']) == 2


@pytest.mark.parametrize(
    ('old', 'new', 'topic'),
    [
        ('W,1,09', 'W,0,09', 'vessel/fix'),
        ('3.9,N,7.2,K,A', '3.9,N,7.2,K,N', 'vessel/velocity_ground'),
        ('180.0,T,,M,4.1,N,7.6,K', '180.0,T,,M,,N,,K', 'vessel/velocity_water'),
        ('HEHDT,180.0', 'HEHDT,', 'vessel/heading'),
        ('HEHDT,180.0,T', 'HETHS,180.0,V', 'vessel/heading'),
        ('SDDPT,85.2', 'SDDPT,', 'vessel/echo_sounder/depth'),
        ('GPVTG,090.0,T,,M,3.9,N,7.2,K,A', 'VDVBW,4.0,0.1,V,,,V', 'vessel/velocity_water'),
    ],
)
def test_what_says_of_itself_that_it_is_invalid_is_left_out(run, old, new, topic):
    contents = [content.replace(old, new) for content in LOG[1:]]
    assert contents != LOG[1:]
    said, _ = run([RMC, *contents])
    without = [reason for reason in said.left_out if f'valid reading for {topic}' in reason]
    assert len(without) == 1


def test_drift_to_starboard_is_negative_to_port(run):
    _, found = run([RMC, 'VDVBW,4.0,0.5,A,,,V'])
    assert found['vessel/velocity_water'][0].velocity == pytest.approx([4 * KNOT, -0.5 * KNOT, 0])


@pytest.mark.parametrize(
    ('content', 'depth'),
    [
        ('SDDBT,328.08,f,100.0,M,54.68,F', 100.0),
        ('SDDBT,100.0,f,,M,,F', 30.48),
        ('SDDBT,,f,,M,10.0,F', 18.288),
        ('SDDPT,100.0,2.0,', 100.0),
    ],
)
def test_depths_in_feet_fathoms_and_below_the_waterline(run, content, depth):
    _, found = run([RMC, content])
    assert found['vessel/echo_sounder/depth'][0].distance == pytest.approx(depth)


def test_the_keel_below_the_transducer_is_taken_off_where_the_sentence_does_not_say_it(run):
    mapping = changed('keel_depth: {value: 0.0', 'keel_depth: {value: 2.5')
    _, found = run([RMC, 'SDDPT,100.0,,'], mapping=mapping)
    assert found['vessel/echo_sounder/depth'][0].distance == pytest.approx(97.5)


def test_the_day_goes_on_over_midnight(run):
    contents = [
        RMC.replace('103851', '235959'),
        LOG[1].replace('103851', '235959'),
        LOG[1].replace('103851', '000001'),
    ]
    _, found = run(contents)
    assert [fix.stamp for fix in found['vessel/fix']] == [
        at(23, 59, 59),
        at(23, 59, 59) + 2 * SECOND,
    ]


def test_zda_gives_the_date_too(run):
    _, found = run(['GPZDA,103850.00,01,08,2026,00,00', LOG[1]])
    assert found['vessel/fix'][0].stamp == at(10, 38, 51)


def test_the_date_of_a_receiver_without_a_fix_is_not_believed(run):
    contents = [RMC.replace(',A,5730', ',V,5730').replace('010826', '060180'), *LOG]
    _, found = run(contents)
    assert found['vessel/fix'][0].stamp == at(10, 38, 51)


def test_what_comes_before_the_first_date_is_left_out(run):
    said, found = run([LOG[1], LOG[3], *LOG])
    assert said.left_out[UNDATED] == 2
    assert len(found['vessel/fix']) == 2


def test_a_log_in_which_nothing_says_the_date_is_refused_unless_the_mapping_does(run):
    words = (
        r'no valid RMC or ZDA among 2 lines says the date \(1: GGA with a time of day and no date'
    )
    with pytest.raises(LogError, match=words):
        run([LOG[1], LOG[3]])
    mapping = changed('  time: sentences', '  date: 2026-08-01\n  time: sentences')
    _, found = run([LOG[1], LOG[3]], mapping=mapping)
    assert found['vessel/heading'][0].stamp == at(10, 38, 51)


def test_headings_between_two_times_are_spread_over_the_interval(run):
    heading = 'HEHDT,180.0,T'
    contents = [RMC, *[heading] * 4, RMC.replace('103851', '103852'), *[heading] * 2]
    _, found = run(contents)
    stamps = [one.stamp - at(10, 38, 51) for one in found['vessel/heading']]
    assert stamps == [0, SECOND // 4, SECOND // 2, 3 * SECOND // 4, SECOND, 3 * SECOND // 2]


def test_a_pause_of_the_clock_does_not_spread_readings_over_it():
    moments = [0, SECOND, 2 * SECOND, 600 * SECOND]
    assert spread_stamps(moments, [(2, 'HE'), (2, 'HE')]) == [2 * SECOND, 2 * SECOND + SECOND // 2]


def test_of_two_talkers_the_busier_one_is_heard_or_who_the_mapping_names(run, tmp_path):
    contents = [RMC, 'HEHDT,180.0,T', 'HEHDT,180.0,T', 'GPHDT,90.0,T']
    said, found = run(contents)
    assert len(found['vessel/heading']) == 2
    assert counted(said, 'HDT of GP', 'vessel/heading', 'HE') == 1
    (tmp_path / 'bag').rename(tmp_path / 'first')
    mapping = changed('sentences: [THS, HDT]', 'sentences: [THS, HDT]\n      talkers: [GP]')
    _, found = run(contents, mapping=mapping)
    assert [one.heading for one in found['vessel/heading']] == pytest.approx([0.0])


RECORDED = changed('  time: sentences', '  recorder: {format: iso}\n  time: recorder')


@pytest.mark.parametrize(
    ('front', 'form'),
    [
        ('2026-08-01T10:38:51.250Z,', 'iso'),
        ('[2026-08-01 10:38:51.25] ', 'iso'),
        ('1785580731.25;', 'seconds'),
        ('\\s:GP01,c:1785580731250*1E\\', 'milliseconds'),
    ],
)
def test_times_of_a_recorder_stand_in_front(run, front, form):
    lines = [front + sentence('HEHDT,180.0,T')]
    _, found = run(lines=lines, mapping=RECORDED.replace('iso', form))
    assert found['vessel/heading'][0].stamp == at(10, 38, 51) + SECOND // 4


def test_a_recorders_time_that_is_none_is_an_error_with_its_line(run):
    lines = ['2026-08-01T10:38:51Z ' + sentence(RMC), 'yesterday ' + sentence(RMC)]
    with pytest.raises(LogError, match="line 2: found 'yesterday'"):
        run(lines=lines, mapping=RECORDED)
    said, found = run(lines=lines, mapping=RECORDED, leave_out=True)
    assert len(found['vessel/fix']) == 1
    assert sum(said.left_out.values()) == 1


@pytest.mark.parametrize(
    ('old', 'new', 'words'),
    [
        ('vessel/heading:', 'vessel/course:', 'topics.vessel/course: unknown topic'),
        ('[THS, HDT]', '[HDM]', 'sentences: found HDM,.*THS, HDT'),
        ('value: 1.0, unit: deg', 'value: 1.0, unit: m', "std.unit: found 'm'"),
        ('max_range: {value: 2000.0', 'max_reach: {value: 2000.0', 'max_reach'),
        ('  time: sentences', '  time: recorder', 'recorder: missing'),
        ('  time: sentences', '  date: tomorrow\n  time: sentences', "date: found 'tomorrow'"),
    ],
)
def test_mistakes_in_the_mapping_are_named_with_their_key(run, old, new, words):
    with pytest.raises(LogError, match=words):
        run(mapping=changed(old, new))


def test_a_line_without_end_takes_no_memory(run, tmp_path):
    said, found = run(lines=[sentence(RMC), 'x' * 100_000, sentence(LOG[3])])
    assert len(found['vessel/heading']) == 1
    assert counted(said, '1024 bytes') == 1


def test_no_garbled_log_crashes(run, tmp_path):
    whole = '\n'.join(sentence(content) for content in LOG * 3).encode()
    for number in range(0, len(whole), 61):
        garbled = whole[:number] + b'\xa5,*$' + whole[number + 2 :]
        path = tmp_path / f'{number}.nmea'
        path.write_bytes(garbled)
        import_log(path, MAPPING, tmp_path / f'bag{number}')


@pytest.mark.parametrize(
    ('changed', 'why'),
    [
        (('5730.5000', '9959.4000'), 'latitude'),
        (('15215.2500', '100000.0000'), 'longitude'),
        (('090.0', '720.0'), 'compass angle'),
        (('3.9', '9999.0'), 'east'),
    ],
)
def test_what_cannot_be_is_left_out_by_its_reason(run, changed, why):
    said, found = run([RMC, RMC.replace('103851', '103852').replace(*changed)])
    assert counted(said, f'{why} beyond') == 1
    assert sum(map(len, found.values())) == 3


def test_a_sentence_with_a_letter_that_is_no_hemisphere_is_left_out_whole(run):
    said, found = run([RMC, RMC.replace('103851', '103852').replace(',N,', ',X,')])
    reason = 'sentence $GPRMC: a hemisphere other than N, S, E or W'
    assert said.left_out == {reason: 1}
    assert sum(map(len, found.values())) == 2


@pytest.mark.parametrize(
    ('content', 'topic', 'value'),
    [
        ('GPVTG,090.0,T,,M,,N,7.2,K,A', 'velocity_ground', [2.0, 0, 0]),
        ('VWVHW,180.0,T,,M,,N,7.2,K', 'velocity_water', [2.0, 0, 0]),
        ('VDVBW,4.0,,A,,,V', 'velocity_water', [4 * KNOT, 0, 0]),
    ],
)
def test_speeds_in_other_units_and_along_the_ship_alone(run, content, topic, value):
    _, found = run([RMC.replace(',3.9,090.0', ',,'), content])
    assert found[f'vessel/{topic}'][0].velocity == pytest.approx(value)
