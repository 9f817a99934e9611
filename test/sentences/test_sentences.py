"""Single sentences: as manuals print them, as lines are damaged, and as a table may be wrong."""

import math

import numpy as np
import pytest
from pynmeagps import NMEAReader
from pynmeagps.nmeahelpers import calc_checksum

from trawl_ros.core.errors import SentenceError
from trawl_ros.core.time import SECOND
from trawl_ros.records.fields import WaterColumn
from trawl_ros.records.samples import (
    AttitudeSample,
    FixSample,
    HeadingSample,
    RangeSample,
    WinchSample,
)
from trawl_ros.sentences.assembly import SampleAssembly, samples_of
from trawl_ros.sentences.codec import SentenceReader
from trawl_ros.sentences.framing import (
    HEADER,
    LONGEST_LINE,
    NO_TEXT,
    Foreign,
    SentenceSplitter,
    Unreadable,
    framed,
    parse_line,
    tag_block,
)
from trawl_ros.sentences.table import load_table, load_tables, packaged_systems
from trawl_ros.sentences.writer import SentenceWriter

WATER = WaterColumn(density_kg_m3=1025.0)
TON = 9806.65


@pytest.fixture(scope='module')
def reader():
    return SentenceReader(load_tables(packaged_systems()))


def checked(body, start='$'):
    return framed(start, body, checksum=True).encode()


@pytest.mark.parametrize(
    ('line', 'readings'),
    [
        # In parse_marport_nmea of trawlmetrics, with their checksums.
        (b'$MPMSD,T,PD,23,XST,m,1.13*29', {('door/spread', 'distance'): 1.13}),
        (b'$MPMSD,T,HR,11,DTB,m,2.40*2E', {('sonar/bottom', 'distance'): 2.4}),
        (b'$MPMSD,T,HR,11,DPT,m,0.65*39', {('sonar/pressure', 'depth'): 0.65}),
        # In the tests of a public parser.
        (b'@IIHFB,10.0,M,15.0,M', {
            ('sonar/opening_height', 'distance'): 10.0, ('sonar/bottom', 'distance'): 15.0}),
        (b'@IITDS,80.5,M\r\n', {('door/spread', 'distance'): 80.5}),
        # As the manuals' pictures have them, with numbers.
        (checked('SCWLP,250.5,M,-0.75,M'), {
            ('winch/joint_states', 'port_length'): 250.5,
            ('winch/joint_states', 'port_speed'): -0.75}),
        (checked('SCWTS,4.25,T'), {('winch/joint_states', 'starboard_tension'): 4.25 * TON}),
        (b'@TAWWL,251.0,M,250.0,M,,M', {
            ('winch/joint_states', 'starboard_length'): 251.0,
            ('winch/joint_states', 'port_length'): 250.0}),
        (b'@TAWWT,4.0,3.5,0.0', {
            ('winch/joint_states', 'starboard_tension'): 4.0 * TON,
            ('winch/joint_states', 'port_tension'): 3.5 * TON}),
        (checked('KWIN,0,4.1,T,250.0,M,12.0,rpm'), {
            ('winch/joint_states', 'starboard_tension'): 4.1 * TON,
            ('winch/joint_states', 'starboard_length'): 250.0}),
        (b'# MA DD 01/08/26 10:38:51 LB 0250m LS 0251m LM 0000m TB 3500K TS 4000K TM 0000K 20', {
            ('winch/joint_states', 'port_length'): 250.0,
            ('winch/joint_states', 'starboard_length'): 251.0,
            ('winch/joint_states', 'port_tension'): 3.5 * TON,
            ('winch/joint_states', 'starboard_tension'): 4.0 * TON}),
        (checked('PSCMSM2,091626.00,A,DVTLAM,1,S,84.5,15'), {('door/spread', 'distance'): 84.5}),
        (checked('PSCMSM2,091626.00,V,DVTLAM,1,S,,0'), {('door/spread', 'distance'): math.nan}),
        (checked('GPGGA,103851.00,5730.5000,S,15215.2500,W,1,09,0.9,12.0,M,,M,,'), {
            ('vessel/fix', 'latitude'): -math.radians(57 + 30.5 / 60),
            ('vessel/fix', 'longitude'): -math.radians(152 + 15.25 / 60)}),
    ],
)  # fmt: skip
def test_a_sentence_of_a_manual_is_read(reader, line, readings):
    found = reader.read(parse_line(line)).readings
    assert found.keys() == readings.keys()
    for key, value in readings.items():
        assert found[key] == pytest.approx(value, nan_ok=True)


def test_tag_blocks_headers_and_what_a_recorder_wrote_are_no_hindrance(reader):
    whole = checked('SCWTP,4.25,T')
    stamp = 1_700_000_000_250 * 1_000_000
    for front in (b'', HEADER, tag_block(stamp).encode(), HEADER + tag_block(stamp).encode(),
                  b'2026-08-01T10:38:51.250Z,', b'$SCWTP,4.2'):  # fmt: skip
        frame = parse_line(front + whole + b'\r\n')
        assert reader.read(frame).name == 'port_tension'
        assert frame.tag_time == (stamp if tag_block(stamp).encode() in front else None)
    assert parse_line(b'2026-08-01T10:38:51.250Z,' + whole).front == '2026-08-01T10:38:51.250Z,'
    broken = tag_block(stamp).replace('c:17', 'c:18').encode()
    with pytest.raises(Unreadable, match='tag block'):
        parse_line(broken + whole)


@pytest.mark.parametrize(
    ('line', 'reason'),
    [
        (b'$SCW\xffTP,4.25,T', NO_TEXT),
        (b'hello', 'without a sentence'),
        (checked('SCWTP,4.25,T').replace(b'4.25', b'4.26'), 'checksum is wrong'),
        (b'$SCWTP,4.25,T', r'\$SCWTP: no checksum'),
        (checked('SCWTP,4.2'), r'\$SCWTP: 1 fields, expected 2'),
        (checked('SCWTP,4.2x,T'), r'\$SCWTP: .*number'),
        (checked('SCWTP,nan,T'), r'\$SCWTP: .*number'),
        (checked('SCWLP,820.0,f,0.0,M'), r"\$SCWLP: field 2 is 'f', expected 'M'"),
        (checked('MPMSD,T,PD,23,XST,ft,264.10'), r"field 5 is 'ft', expected 'm'"),
        (checked('XXYYY,1'), r'\$XXYYY'),
        (checked('GPGGA,993851.00,5730.5,N,15215.2,W,1,09,0.9,12.0,M,,M,,'), ' time'),
        (checked('GPGGA,103851.00,5790.5,N,15215.2,W,1,09,0.9,12.0,M,,M,,'), 'a position that is'),
        (checked('GPGGA,103851.00,5730.5,X,15215.2,W,1,09,0.9,12.0,M,,M,,'), 'hemisphere'),
    ],
)
def test_a_line_that_cannot_be_read_says_why(reader, line, reason):
    with pytest.raises(Unreadable, match=reason):
        reader.read(parse_line(line))


def test_what_others_say_is_told_apart_from_what_is_broken(reader):
    with pytest.raises(Foreign):
        reader.read(parse_line(checked('GPGSV,1,1,00')))
    temperature = reader.read(parse_line(b'$MPMSD,T,HR,11,TMP,c,14.53*0E'))
    assert (temperature.system, temperature.readings) == ('marport', {})


def test_noise_never_does_more_than_be_refused(reader):
    """Seeded fuzz: random bytes, sentences with bytes changed, dropped, doubled and cut."""
    draws = np.random.default_rng(2323)
    whole = [
        checked('PSCMSM2,091626.00,A,DVTLAM,1,S,84.5,15'),
        checked('GPGGA,103851.00,5730.5,N,15215.2,W,1,09,0.9,12.0,M,,M,,'),
        checked('GPZDA,204954.000,24,02,2026,00,00'),
        b'# MA DD 01/08/26 10:38:51 LB 0250m LS 0251m LM 0000m TB 3500K TS 4000K TM 0000K 20',
        tag_block(SECOND).encode() + checked('SCWTP,4.25,T'),
        b'@IIHFB,10.0,M,15.0,M',
    ]
    understood = 0
    for _ in range(6000):
        line = bytearray(whole[draws.integers(len(whole))])
        for _ in range(int(draws.integers(1, 4))):
            at = int(draws.integers(len(line) + 1))
            match int(draws.integers(4)):
                case 0:
                    line[at:at] = draws.bytes(int(draws.integers(1, 6)))
                case 1:
                    del line[at : at + int(draws.integers(1, 9))]
                case 2:
                    line[at:at] = line[:at]
                case 3:
                    line[at : at + 1] = b'%d' % draws.integers(10)
        # Also with a checksum that is right, so that fields themselves are met.
        if draws.integers(2) and bytes(line).isascii():
            body = bytes(line).lstrip(b'$@').partition(b'*')[0].decode()
            line = bytearray(f'${body}*{calc_checksum(body)}'.encode())
        try:
            reader.read(parse_line(bytes(line)))
        except Unreadable:
            continue
        understood += 1
    assert 0 < understood < 3000


def test_a_stream_is_cut_into_lines_in_bounded_memory():
    splitter = SentenceSplitter()
    assert list(splitter.feed(b'$A,1\r\n$B')) == [b'$A,1']
    assert list(splitter.feed(b',2\n\n\r$C')) == [b'$B,2']
    assert list(splitter.datagram(b',3')) == [b'$C,3']
    for _ in range(100):
        assert list(splitter.feed(b'x' * 10_000)) == []
        assert len(splitter._rest) <= LONGEST_LINE
    assert list(splitter.feed(b'yz\n$D,4\n')) == [b'$D,4']
    assert splitter.too_long == 1


def test_sides_that_come_one_by_one_make_one_sample():
    table = load_table('scantrol')
    reader = SentenceReader([table])
    bodies = ('SCWLP,250.5,M,-0.75,M', 'SCWLS,251.5,M,0.25,M', 'SCWTP,4.00,T', 'SCWTS,3.00,T')
    heard = [(reader.read(parse_line(checked(body))), 7) for body in bodies]
    (sample,) = samples_of(heard, SampleAssembly([table], WATER))
    assert sample == WinchSample(7, (250.5, 251.5), (-0.75, 0.25), (4 * TON, 3 * TON))
    # One lost: the others come when the next one begins, and at the end.
    lost = [*heard[:3], *((item, SECOND) for item, _ in heard)]
    first, second = samples_of(lost, SampleAssembly([table], WATER))
    assert math.isnan(first.tensions[1])
    assert first.lengths == (250.5, 251.5)
    assert second.stamp == SECOND


def test_a_position_and_a_heading_carry_over_when_they_are_rounded():
    writer = SentenceWriter([load_table('ship')], WATER)
    (gga,) = writer.write(FixSample(0, 41.99999999, -70.0, 1.0))
    assert ',4200.00000,N,07000.00000,W,' in gga
    (hdt,) = writer.write(HeadingSample(0, math.pi / 2 + 1e-5, 0.1))
    assert hdt.startswith('$HEHDT,0.0,T*')


@pytest.mark.parametrize('year', [1970, 2026])
def test_the_ship_is_understood_by_pynmeagps(year):
    """An outside reader finds what was put in."""
    writer = SentenceWriter([load_table('ship')], WATER)
    stamp = ((year - 1970) * 365 + (year - 1969) // 4) * 86_400 * SECOND + 3_661_250_000_000
    (gga,) = writer.write(FixSample(stamp, 57.508333333, -152.25416667, 1.0))
    parsed = NMEAReader.parse(gga.encode())
    assert (parsed.lat, parsed.lon) == pytest.approx((57.508333333, -152.25416667), abs=1e-7)
    (zda,) = writer.write_clock(stamp)
    clock = NMEAReader.parse(zda.encode())
    assert (clock.day, clock.month, clock.year, str(clock.time)) == (1, 1, year, '01:01:01.250000')


def test_a_system_sends_no_more_often_than_its_manual_says():
    def sent(**given):
        writer = SentenceWriter([load_table('marport')], WATER, **given)
        # No echo makes no sentence, and the next reading need not wait for it.
        distances = [math.inf, *(80.0 + second for second in range(1, 20))]
        return [
            (second, text)
            for second, distance in enumerate(distances)
            for text in writer.write(
                RangeSample(second * SECOND, 'spread', distance, 0.1, 1.0, 400.0)
            )
        ]

    assert [second for second, _ in sent()] == [1, 7, 13, 19]
    assert [second for second, _ in sent(every_reading=True)] == list(range(1, 20))
    assert dict(sent()).items() <= dict(sent(every_reading=True)).items()


def test_pitch_and_roll_that_are_sent_are_of_one_instant():
    writer = SentenceWriter([load_table('marport')], WATER)
    sent = [
        len(writer.write(AttitudeSample(second * SECOND, 'port', 0.1, 0.2, 0.01)))
        for second in range(13)
    ]
    assert sent == [2, *[0] * 5, 2, *[0] * 5, 2]


def test_a_rate_says_who_says_so(tmp_path):
    path = tmp_path / 'own.yaml'
    path.write_text(TABLE.replace('    source:', '    least_interval_s: 2\n    source:'))
    with pytest.raises(SentenceError, match='rate_source: expected with least_interval_s'):
        load_table(path)


TABLE = """
system: own
title: Own winch
sentences:
  length:
    address: PXYZL
    fields: [{reading: winch/joint_states port_length, unit: ft, decimals: 1}]
    source: its manual
"""


def test_a_user_adds_a_sentence_of_her_own(tmp_path):
    path = tmp_path / 'own.yaml'
    path.write_text(TABLE)
    reader = SentenceReader(load_tables([path, 'scantrol']))
    spoken = reader.read(parse_line(checked('PXYZL,100.0')))
    assert spoken.system == 'own'
    assert spoken.readings == {('winch/joint_states', 'port_length'): pytest.approx(30.48)}


def test_a_distance_without_a_least_one_keeps_its_largest(tmp_path):
    path = tmp_path / 'own.yaml'
    topics = 'topics: {door/spread: {max_range: {value: 300, unit: m}}}\n'
    path.write_text(
        topics + TABLE.replace('winch/joint_states port_length', 'door/spread distance')
    )
    stated = load_table(path).stated('door/spread', WaterColumn(density_kg_m3=1025.0))
    assert (stated.min_range, stated.max_range) == (0.0, 300.0)


@pytest.mark.parametrize(
    ('old', 'new', 'complaint'),
    [
        ('ft', 'kn', r"sentences.length.fields\[0\].unit: found 'kn'"),
        ('port_length', 'middle_length', "field 'middle_length' of winch/joint_states, expected"),
        ('winch/joint_states', 'winch', "topic 'winch'"),
        ('PXYZL', 'pxyzl', "address: found 'pxyzl'"),
        ('source: its manual', '', 'source'),
        ('{reading', '{text: M, reading', 'found text and reading'),
    ],
)  # fmt: skip
def test_a_wrong_table_is_refused_with_key_found_and_expected(tmp_path, old, new, complaint):
    path = tmp_path / 'own.yaml'
    path.write_text(TABLE.replace(old, new))
    with pytest.raises(SentenceError, match=complaint):
        load_table(path)


def test_one_system_twice_is_refused():
    with pytest.raises(SentenceError, match='system rapp'):
        load_tables(['rapp', 'rapp'])
