"""Logs: tables cell by cell, and sentences of NMEA 0183 field by field with right checksums."""

from functools import reduce
from operator import xor
from pathlib import Path

from hypothesis import strategies as st
from hypothesis.strategies import DrawFn

from hostile.mutations import mutated
from hostile.target import Files, Target
from trawl_ros.bags.logs.clock import WORDS
from trawl_ros.bags.logs.draft import draft_mapping
from trawl_ros.bags.logs.import_log import import_log
from trawl_ros.core.errors import TrawlError

CELLS = (
    *('', ' ', '0', '-1', '1e999', 'nan', '-inf', '9' * 400, '1_000', '0x1f', '1,5', '٣', '\x00'),
    *(
        '=1+1',
        '"',
        '""',
        "'",
        '\\',
        '\n',
        '\r',
        '�',
        'x' * 5000,
        'N',
        'Q',
        '2026-99-99',
        '24:00:00',
    ),
    *('2026-99-99', '10:00:00', '0001-01-01', '9999-12-31', '-9223372036854775808', '1e18', '89.9'),
)
NAMES = ('Date', 'Time', 'Scope', 'Tension', 'Depth', 'Pitch', 'Roll', 'Speed', 'Lat', 'Lon')
ROW = ('2026-08-01', '10:00:00', '125', '2.7', '51.2', '-2.7', '13.0', '3.9', '57.5', '-152.25')
ENCODINGS = ('utf-8', 'utf-16', 'utf-16-le', 'utf-32', 'cp1252', 'utf-7', 'hex', 'idna', 'rot13')
FORMATS = ('%Y-%m-%d %H:%M:%S', '%c', '%j', '%Q', '%', '%Y' * 9, *WORDS)
MAPPING = """
clock: {{columns: [Date, Time], format: '{format}', utc_offset_h: -8}}
layout: {{encoding: {encoding}, separator: '{separator}', decimal: '{decimal}', skip_lines: {skip}}}
water: {{density_kg_m3: 1025.0}}
topics:
  winch/joint_states:
    fields:
      port_length: {{column: Scope, unit: fathom}}
      port_tension: {{column: Tension, unit: tf, scale: {scale}, offset: {offset}}}
  door/port/pressure:
    fields: {{depth: {{column: Depth, unit: m, scale: {scale}}}}}
    std: {{value: 0.5, unit: m}}
  door/port/attitude:
    fields: {{pitch: {{column: Pitch, unit: deg}}, roll: {{column: Roll, unit: deg}}}}
  vessel/velocity_ground:
    fields: {{speed: {{column: Speed, unit: kn}}, compass_course: {{column: Roll, unit: deg}}}}
  vessel/fix:
    fields: {{latitude: {{column: Lat, unit: deg_min}}, longitude: {{column: Lon, unit: deg}}}}
"""

SENTENCES = (
    *('GPRMC,103851.00,A,5730.5000,N,15215.2500,W,3.9,090.0,010826,,,A', 'HEHDT,180.0,T'),
    *('GPGGA,103851.00,5730.5,N,15215.2,W,1,09,0.9,12.0,M,,M,,', 'GPVTG,090.0,T,,M,3.9,N,7.2,K,A'),
    *('VWVHW,180.0,T,,M,4.1,N,7.6,K', 'VDVBW,4.1,0.1,A,3.9,0.0,A,,V,,V', 'SDDPT,85.2,-3.0,'),
    *('SDDBT,279.5,f,85.2,M,46.6,F', 'GPZDA,103851.00,01,08,2026,00,00', 'HETHS,180.0,A'),
    *('GPGLL,5730.5,N,15215.2,W,103851.00,A,A', 'GNGNS,103851.00,5730.5,N,15215.2,W,A,9,1,1,,,'),
    *(
        'MPMSD,T,PD,23,XST,m,84.50',
        'PSCMSM2,091626.00,A,DVTLAM,1,S,84.5,15',
        'SCWLP,250.5,M,-0.7,M',
    ),
    *('PSIMTV80,103851,260801,,,,,,,,,,,,,01,a01,a02,84.50,10,', 'KWIN,0,4.1,T,250.0,M,1.0,rpm'),
    *('GPGSV,1,1,00', 'PASHR,1', 'PUBX,00', '!AIVDM,1,1,,A,x,0', ''),
)
FIELDS = (
    *CELLS,
    *(
        '5760.0',
        '9999.99',
        '-5730.5',
        '235960',
        '240000.00',
        '103851.999999999',
        '320226',
        '000000',
    ),
    *('A', 'V', 'S', 'E', '*', '$', '*00', ',', 'T' * 70, 'RMC', 'GPZDA'),
)
FRONTS = (b'', b'', b'2026-08-01T10:38:51Z,', b'\\c:1785580731*5A\\', b'9' * 30 + b',', b'\xff ')
NMEA = """
nmea:
  time: {time}
  recorder: {{format: iso}}
  need_checksum: {checksum}
  topics:
    vessel/fix: {{sentences: [GGA, GNS, RMC, GLL], std: {{value: 5.0, unit: m}}}}
    vessel/velocity_ground: {{sentences: [VTG, RMC]}}
    vessel/velocity_water: {{sentences: [VBW, VHW]}}
    vessel/heading: {{sentences: [THS, HDT], std: {{value: 1.0, unit: deg}}}}
    vessel/echo_sounder/depth:
      sentences: [DPT, DBT]
      std: {{value: 0.5, unit: m}}
      min_range: {{value: 0.5, unit: m}}
      max_range: {{value: 2000.0, unit: m}}
"""


@st.composite
def tables(draw: DrawFn) -> Files:
    """A table with its mapping; some cells, the encoding and the clock are others."""
    encoding = draw(st.sampled_from(('utf-8', 'utf-8', 'utf-8', *ENCODINGS)))
    separator = draw(st.sampled_from((',', ',', ';', 'tab', 'blanks', '"')))
    sign = {'tab': '\t', 'blanks': ' '}.get(separator, separator)
    rows = [list(NAMES)]
    rows += [list(ROW) for _ in range(draw(st.integers(0, 4)))]
    for _ in range(draw(st.integers(0, 4))):
        row = draw(st.sampled_from(rows))
        place = draw(st.integers(0, len(row)))
        row[place : place + draw(st.integers(0, 2))] = [draw(st.sampled_from(CELLS))]
    text = draw(st.sampled_from(('\n', '\r\n', '\r'))).join(sign.join(row) for row in rows)
    written = encoding if encoding.startswith(('utf-16', 'utf-32')) else 'utf-8'
    number = st.sampled_from(('1', '1', '0', '-1', '1.0e+300', '.nan', '.inf'))
    mapping = MAPPING.format(
        format=draw(st.sampled_from((FORMATS[0], FORMATS[0], FORMATS[0], *FORMATS))),
        encoding=encoding,
        separator=separator,
        decimal=draw(st.sampled_from(('.', '.', ','))),
        skip=draw(st.sampled_from((0, 0, 1, 10**9))),
        scale=draw(number),
        offset=draw(number),
    )
    content = draw(st.one_of(st.just(text.encode(written)), mutated(st.just(text.encode(written)))))
    return {'log.csv': content, 'mapping.yaml': mapping.encode()}


@st.composite
def lines(draw: DrawFn) -> bytes:
    """A sentence with other fields, most often with the checksum that belongs to it."""
    fields = draw(st.sampled_from(SENTENCES)).split(',')
    for _ in range(draw(st.integers(0, 3))):
        place = draw(st.integers(0, len(fields)))
        fields[place : place + draw(st.integers(0, 2))] = [draw(st.sampled_from(FIELDS))]
    said = ','.join(fields).encode()
    checksum = f'*{reduce(xor, said, 0):02X}'.encode()
    end = draw(st.sampled_from((checksum, checksum, checksum, b'', b'*', b'*ZZ', b'*0')))
    return draw(st.sampled_from(FRONTS)) + b'$' + said + end


@st.composite
def sentences(draw: DrawFn) -> Files:
    """A log of NMEA 0183 with its mapping."""
    sound = st.lists(lines(), max_size=12).map(b'\r\n'.join)
    mapping = NMEA.format(
        time=draw(st.sampled_from(('sentences', 'sentences', 'recorder'))),
        checksum=draw(st.sampled_from(('true', 'false'))),
    )
    return {
        'log.nmea': draw(st.one_of(sound, sound, mutated(sound))),
        'mapping.yaml': mapping.encode(),
    }


def read_table(given: Path, results: Path) -> None:
    """Import a table, with and without leaving out rows that cannot be understood."""
    results.mkdir()
    try:
        import_log(given / 'log.csv', given / 'mapping.yaml', results / 'strict')
    except TrawlError:
        import_log(given / 'log.csv', given / 'mapping.yaml', results / 'bag', leave_out=True)


def read_sentences(given: Path, results: Path) -> None:
    """Import a log of NMEA 0183, so that as much as may be is read."""
    results.mkdir()
    import_log(given / 'log.nmea', given / 'mapping.yaml', results / 'bag', leave_out=True)


PROBES = (
    b'[NOTUS TEXTFILE V3.1]\nTow Date: 11-Jul-2019 7:51:17\nPlacement: Starboard\n'
    b'Code,Time,Range(m),Data(m),Comment\nC24S,07:53:27,54.6,35.2,\nC24S,23:53:27,---,---,\n',
    b'CPU Date and Time,GPS Date,GPS Time,Latitude,Longitude,Speed,Heading,Validity,'
    b'Transducer Name,Sensor Name,Sensor Value,Error Code,Hydrophone,Signal Strength\n'
    b'Fri Aug 16 16:24:22 2013,16-Aug-2013,192424,47 58.5 N,064 57.9 W,2.1,86.2,A,DoorSpread,'
    b'DoorMaster,10.0,D,S,5.0\n',
    b'FileName: X\n Date Time Latitude Longitude Speed Primary DoorSpread\n'
    b'100811  205148  48   4.9282 N  63  41.4732 W   2.1        2.2        6.3*\n',
    b'"Filename: x.SCD"\n"DI1"\n"1997-07-14""11:41:29""N047:54.860""W063:35.500"    0.0   0.00     '
    b'3.8   0.6"."     0.6  10.0  6"."    40.1   0.0"."       0"?"     0.0   0.0"?"" 0"\n',
)
"""Files of receivers of net sensors."""


def read_probe(given: Path, results: Path) -> None:
    """Draft a mapping of a file of a receiver, and import the file by it."""
    results.mkdir()
    (results / 'mapping.yaml').write_text(draft_mapping(given / 'log.txt'))
    import_log(given / 'log.txt', results / 'mapping.yaml', results / 'bag', leave_out=True)


def _table(clock: str, encoding: str, skip: int) -> Files:
    mapping = MAPPING.format(
        format=clock,
        encoding=encoding,
        separator=',',
        decimal='.',
        skip=skip,
        scale=1,
        offset=0,
    )
    return {'log.csv': ','.join(NAMES).encode(), 'mapping.yaml': mapping.encode()}


def _sentence(said: str) -> Files:
    mapping = NMEA.format(time='sentences', checksum='false')
    return {'log.nmea': f'${said}'.encode(), 'mapping.yaml': mapping.encode()}


TARGETS = (
    Target(
        name='probe-log',
        inputs=mutated(st.sampled_from(PROBES), tuple(cell.encode() for cell in CELLS)).map(
            lambda content: {'log.txt': content}
        ),
        read=read_probe,
        examples=150,
        known={'header-alone': lambda: {'log.txt': PROBES[2].split(b'1008')[0]}},
    ),
    Target(
        name='csv-log',
        inputs=tables(),
        read=read_table,
        examples=150,
        known={
            'skip-10⁹-lines': lambda: _table('%Y-%m-%d %H:%M:%S', 'utf-8', 10**9),
            'encoding-that-is-none-of-text': lambda: _table('iso', 'hex', 0),
        },
    ),
    Target(
        name='nmea-log',
        inputs=sentences(),
        read=read_sentences,
        examples=150,
        known={'empty-field-of-PASHR': lambda: _sentence('PASHR,')},
    ),
)
