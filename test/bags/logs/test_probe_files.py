"""Files of receivers of net sensors: what is a reading, what is held, and what is a false pulse."""

import re
from collections import Counter
from pathlib import Path

import pytest
from click.testing import CliRunner

from trawl_ros.bags.logs import probe_files
from trawl_ros.bags.logs.draft import draft_mapping
from trawl_ros.bags.logs.import_log import import_log
from trawl_ros.bags.logs.layout import BadRow, LogRow
from trawl_ros.bags.logs.mapping import load_mapping
from trawl_ros.bags.logs.probe_files import NO_ANSWER, format_of, read_probe_rows
from trawl_ros.bags.reader import Bag
from trawl_ros.cli.main import trawl
from trawl_ros.core.errors import LogError
from trawl_ros.messages.from_messages import to_sample

ROOT = Path(__file__).parents[3]
FOLDER = ROOT.parent / 'shared/data/probe_logs'

POLLS = [(53.0, 26.0), (53.2, 25.8), (53.1, 26.1), (89.5, -10.4), (53.0, 26.2), (53.1, 25.9)]
NOTUS = (
    '[NOTUS TEXTFILE V3.1]\nTow Date: 11-Jul-2026 23:58:50\n\nTransponder: C24S\n'
    'Placement: Starboard\n\nCode,Time,Range(m),Data(m),Latitude,Longitude,Comment\n'
    + ''.join(
        f'C24S,{"23:59" if n < 3 else "00:00"}:{n:02d},{r},{d},---,---,\n'
        for n, (r, d) in enumerate(POLLS)
    )
    + 'C24S,00:00:40,---,---,---,---,\n'
)
ESONAR = (
    'Ship Number,Trip Number,Tow Number\nX,1,1\nComments\n"x"\nCPU Date and Time,GPS Date,GPS Time,'
    'Latitude,Longitude,Speed,Heading,Validity,Transducer Name,Sensor Name,Sensor Value,Error Code,'
    'Hydrophone,Signal Strength\n'
    + ''.join(
        f'Fri Aug 16 16:24:{cpu} 2013,16-Aug-2013,1924{n:02d},47 58.577500 N,064 57.948500 W,2.1,'
        f'86.2,A,{sensor},x,{value},{code},S,{signal}\n'
        for n, (cpu, sensor, value, code, signal) in enumerate(
            [
                ('22', 'DoorSpread', '10.0', 'D', 1),
                ('22', 'DoorSpread', '10.0', 'D', 1),
                ('24', 'DoorSpread', '0.000000', 'E', 2),
                ('25', 'Depth', '74.8', 'D', 3),
            ]
        )
    )
)
NETMIND = (
    'FileName: C:\\X.TXT\nLocal Time: Wed Aug 11 17:43:28 2010\n\nShip:\nComments:\n'
    ' Date    Time     Latitude       Longitude    Speed    Primary DoorSpread\n'
    '100811  205147  48   4.9286 N  63  41.4725 W   2.1        2.2       77.5\n'
    '100811  205148  48   4.9282 N  63  41.4732 W   2.1        2.2        6.3*\n'
    '100811  205149  48   4.9279 N  63  41.4739 W   2.1        2.2        6.3\n'
)
SCD = (
    '"Filename: x.SCD"\n"Date    : 1997-07-14 11:41:29"\n"Format  : Normal"\n"Comments: x"\n'
    '"YYYY"   "DI1"   "x"\n"----"\n'
    '"1997-07-14""11:41:29""N047:54.860""W063:35.500"    0.0   0.00     3.8   0.6"."     0.6  '
    '10.0  6"."    40.1   0.0"."       0"?"     0.0   0.0"?"" 0"\n'
    '"1997-07-14""11:41:36""N047:54.860""W063:35.500"    0.0   0.00   998.0   0.6"."     0.6  '
    '10.0  6"."    40.1   0.0"."       0"?"     0.0   0.0"?"" 0"\n'
)
FILES = {'notus': NOTUS, 'esonar': ESONAR, 'netmind': NETMIND, 'scanmar_scd': SCD}


def written(folder, text, name='log.txt'):
    path = folder / name
    path.write_text(text)
    return path


def samples(bag, topic):
    found = Bag(bag).messages([f'/trawl/{topic}'])
    return [to_sample(topic, one.message) for one in found]


@pytest.mark.parametrize('form', FILES)
def test_each_format_is_recognised_and_becomes_a_bag(form, tmp_path):
    path = written(tmp_path, FILES[form])
    assert format_of(FILES[form].splitlines()) == form
    (tmp_path / 'draft.yaml').write_text(draft_mapping(path))
    done = import_log(path, tmp_path / 'draft.yaml', tmp_path / 'bag')
    assert done.counts['/trawl/door/spread'] == {'notus': 5}.get(form, 1)


def test_the_day_of_a_tow_goes_on_at_midnight_and_false_pulses_are_left_out(tmp_path):
    done = import_log(written(tmp_path, NOTUS), 'notus', tmp_path / 'bag')
    spreads = samples(tmp_path / 'bag', 'door/spread')
    assert [one.distance for one in spreads] == pytest.approx([26.0, 25.8, 26.1, 26.2, 25.9])
    assert (spreads[-1].stamp - spreads[0].stamp) / 1e9 == 65.0
    assert len(samples(tmp_path / 'bag', 'door/starboard/slant_range')) == 5
    assert any('opposite amounts: 1 of Starboard' in note for note in done.notes)


@pytest.mark.parametrize(
    ('form', 'column', 'wanted'),
    [
        ('esonar', 'DoorSpread', (2, 1)),
        ('esonar', 'Depth', (1, 0)),
        ('netmind', 'DoorSpread', (1, 0)),
        ('netmind', 'Primary', (0, 0)),
        ('scanmar_scd', 'DI1', (2, 1)),
        ('scanmar_scd', 'CS1', (0, 0)),
    ],
)
def test_held_values_are_no_readings_and_errors_are_missing(form, column, wanted, tmp_path):
    rows, _ = read_probe_rows(written(tmp_path, FILES[form]), form)
    assert count_readings(rows)[column] == wanted


def count_readings(rows):
    """New readings by column, and those of them that gave no value."""
    cells = [(name, text) for row in rows for name, text in row.cells.items()]
    new = Counter(name for name, text in cells if text)
    missing = Counter(name for name, text in cells if text == NO_ANSWER)
    return {name: (new[name], missing[name]) for name, _ in cells}


def test_a_line_that_cannot_be_read_is_named(tmp_path):
    path = written(tmp_path, NOTUS.replace('C24S,23:59:01', 'C24S,23:xx:01'))
    with pytest.raises(LogError, match=r'log\.txt: line 9: expected code'):
        import_log(path, 'notus', tmp_path / 'bag')
    with pytest.raises(LogError, match='line 1: found a Scanmar file with a date and no time'):
        import_log(written(tmp_path, '30061990 002    4.4\n'), 'scanmar_scd', tmp_path / 'bag')


def test_all_faults_of_a_mapping_are_told_at_once(tmp_path):
    path = written(
        tmp_path,
        'clock: {columns: [t], format: iso}\n'
        'topics:\n'
        '  winch/joint_states: {fields: {port_tension: {column: a, unit: mile}}}\n'
        '  door/port/pressure: {fields: {depth: {column: b, unit: m}}}\n'
        '  door/nowhere: {fields: {depth: {column: b, unit: m}}}\n',
        'mapping.yaml',
    )
    with pytest.raises(LogError) as told:
        load_mapping(path)
    lines = str(told.value).splitlines()
    assert len(lines) == 3
    assert [bool(re.search(key, line)) for key, line in zip(
        ('port_tension.unit', 'water: missing', 'door/nowhere'), lines, strict=True
    )] == [True] * 3  # fmt: skip


def test_a_draft_of_a_table_imports_it(tmp_path):
    log = written(
        tmp_path,
        'Time;Warp P;Load port (t);Door spread (m);Door depth port (m);Crew\n'
        ';fm;;;;\n2026-08-01 10:00:00;400;5.1;81.0;90.5;7\n',
        'log.csv',
    )
    told = CliRunner().invoke(trawl, ['import-log', str(log), '--draft'])
    assert told.exit_code == 0, told.output
    assert 'not recognised: Crew' in told.output
    mapping = written(tmp_path, told.output, 'draft.yaml')
    import_log(log, mapping, tmp_path / 'bag')
    (winch,) = samples(tmp_path / 'bag', 'winch/joint_states')
    assert (winch.lengths[0], winch.tensions[0]) == pytest.approx((400.0 * 1.8288, 5.1 * 9806.65))
    (spread,) = samples(tmp_path / 'bag', 'door/spread')
    assert spread.distance == 81.0 < spread.max_range


@pytest.mark.skipif(not FOLDER.is_dir(), reason=f'{FOLDER} is not there')
def test_files_of_a_survey_have_the_counts_of_their_description(monkeypatch):
    monkeypatch.setattr(probe_files, '_blank_false_pulses', lambda rows: {})
    counts = {}
    for path in sorted(FOLDER.glob('*/*')):
        form = format_of(path.read_bytes().decode('latin-1').splitlines())
        if form is None:
            assert re.match(r'scs\.scanmar\.199\d_S9', path.name), 'only these have no clock'
            continue
        rows, _ = read_probe_rows(path, form)
        assert not any(isinstance(row, BadRow) for row in rows)
        assert all(isinstance(row, LogRow) for row in rows)
        counts[f'{form}/{path.name}'.replace('_scd', '')] = count_readings(rows)
    checked = 0
    for line in (FOLDER / 'FORMATS.md').read_text().splitlines():
        cells = [cell.strip() for cell in line.split('|')]
        if len(cells) < 10 or cells[1] not in counts or not cells[3].isdigit():
            continue
        column = column_of(cells[2])
        if column in counts[cells[1]]:
            found, missing = counts[cells[1]][column]
            share = f'{100 * missing / found:.1f}' if found else ''
            assert (cells[1], column, found, share) == (cells[1], column, int(cells[3]), cells[4])
            checked += 1
    assert checked == 45


def column_of(quantity):
    """Column of a quantity as the description names it."""
    if ': ' in quantity:
        place, what = quantity.split(': ')
        return f'{place} {"range" if what == "slant range" else "data"}'
    words = {'wing/door spread (DoorMaster)': 'DoorSpread', 'depth': 'Depth', 'speed': 'Speed'}
    if quantity in words:
        return words[quantity]
    quantity = quantity.removeprefix('headline height ')
    return re.split(r' \(| spread| clearance| opening', quantity)[0]
