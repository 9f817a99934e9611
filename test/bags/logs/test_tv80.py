"""Measurements of TV80, by the columns that two surveys had."""

from pathlib import Path

import pytest

from trawl_ros.bags.logs.import_log import NO_READING, import_log
from trawl_ros.bags.samples import SampleStream
from trawl_ros.core.errors import LogError
from trawl_ros.core.time import SECOND
from trawl_ros.records.fields import WaterColumn, fields_of_sample

MAPPING = Path(__file__).parents[3] / 'config/logs/tv80.yaml'
WATER = WaterColumn(density_kg_m3=1025.0)

# SWFSC/estimATM, Doc/settings/settings_2506SH.R and settings_2606RL.R.
COLUMNS = {
    '2025': (
        'UnixTimeSeconds;DateTime;VES_Latitude;VES_Longitude;VES_Heading;VES_Course_True;'
        'VES_Speed;VES_Course_True;VES_Speed;TRAWLEYE_Roll_code;TRAWLEYE_Depth_code;TWL_Depth;'
        'TWL_Battery;TWL_Flow1;TWL_Flow1_uncompensated_c;TWL_Geometry_Std;TWL_Pitch;'
        'TWL_Geometry_Prt;TWL_Geometry_Dif_c;DOR_Depth_Std;DOR_Temperature_Std;DOR_Battery_Prt;'
        'DOR_Roll_Std;DOR_Pitch_Std;DOR_Roll_Prt;DOR_Pitch_Prt;DOR_Depth_Prt;DOR_Depth_Dif_c;'
        'DOR_Battery_Prt;DOR_Battery_Std;DOR_Spread;DOR_Battery_Std'
    ),
    '2026': (
        'UnixTimeSeconds;DateTime;VES_Heading;VES_Latitude;VES_Longitude;VES_Heading;'
        'VES_Course_True;VES_Speed;VES_Speed;VES_Course_True;TWL_Depth;TWL_Depth;VES_Temperature;'
        'DOR_Battery_Std;DOR_Pitch_Std;DOR_Roll_Std;DOR_Depth_Std;DOR_Pitch_Prt;DOR_Depth_Prt;'
        'DOR_Battery_Std;DOR_Temperature_Std;DOR_Roll_Prt;DOR_Depth_Dif_c;DOR_Battery_Prt;'
        'DOR_Spread'
    ),
}
FIRST = {
    'VES_Latitude': '32 42.1234 N',
    'VES_Longitude': '117 15.4321 W',
    'VES_Heading': '181.2',
    'VES_Course_True': '180.0',
    'VES_Speed': '3.9',
    'TWL_Depth': '61.5',
    'DOR_Depth_Prt': '51.25',
    'DOR_Depth_Std': '52.75',
    'DOR_Pitch_Prt': '-2.5',
    'DOR_Roll_Prt': '6.5',
    'DOR_Pitch_Std': '-3.5',
    'DOR_Roll_Std': '-5.5',
    'DOR_Spread': '84.50',
}
START = 1_750_000_000


def table(names, rows):
    """A file of TV80; of columns of one name all but the first hold something else."""
    lines = [names]
    for second, cells in enumerate(rows):
        said, texts = set(), []
        for name in names.split(';'):
            known = {'UnixTimeSeconds': str(START + second), **cells}
            texts.append('77' if name in said else known.get(name, ''))
            said.add(name)
        lines.append(';'.join(texts))
    return '\r\n'.join(lines) + '\r\n'


def imported(tmp_path, text):
    log = tmp_path / '20250615_150640_measurements.csv'
    log.write_text(text)
    done = import_log(log, MAPPING, tmp_path / 'bag')
    found = {}
    for _, sample in SampleStream([tmp_path / 'bag'], 'trawl'):
        topic, fields = fields_of_sample(sample, WATER)
        found.setdefault(topic, []).append((sample.stamp // SECOND - START, fields))
    return done, found


@pytest.mark.parametrize('year', COLUMNS)
def test_every_reading_of_a_survey_s_file_comes_once(year, tmp_path):
    rows = [FIRST, FIRST, FIRST | {'DOR_Spread': '84.75', 'DOR_Depth_Prt': ''}]
    done, found = imported(tmp_path, table(COLUMNS[year], rows))
    assert done.notes == ()
    spread = [(second, fields['distance']) for second, fields in found['door/spread']]
    assert spread == [(0, pytest.approx(84.5)), (2, pytest.approx(84.75))]
    assert {topic: len(samples) for topic, samples in found.items() if len(samples) > 1} == {
        'door/spread': 2
    }
    first = {topic: samples[0][1] for topic, samples in found.items()}
    assert first['door/port/pressure']['depth'] == pytest.approx(51.25)
    assert first['door/starboard/pressure']['depth'] == pytest.approx(52.75)
    assert first['sonar/pressure']['depth'] == pytest.approx(61.5)
    # Nose down is positive in the project.
    degree = 0.017453292519943295
    assert first['door/port/attitude'] == pytest.approx(
        {'pitch': 2.5 * degree, 'roll': 6.5 * degree}
    )
    assert first['vessel/velocity_ground']['speed'] == pytest.approx(3.9 * 1852 / 3600)
    assert first['vessel/heading']['compass_heading'] == pytest.approx(181.2 * degree)
    assert first['vessel/fix'] == pytest.approx(
        {
            'latitude': (32 + 42.1234 / 60) * degree,
            'longitude': -(117 + 15.4321 / 60) * degree,
        }
    )


def test_sensors_that_were_not_aboard_are_told_and_left_out(tmp_path):
    names = 'UnixTimeSeconds;DateTime;TWL_Depth;DOR_Depth_Prt;DOR_Pitch_Prt;DOR_Spread'
    done, found = imported(tmp_path, table(names, [FIRST]))
    assert set(found) == {'sonar/pressure', 'door/port/pressure', 'door/spread'}
    assert any('door/port/attitude' in note and 'DOR_Roll_Prt' in note for note in done.notes)
    assert len(done.notes) == 6


def test_a_file_of_something_else_is_refused(tmp_path):
    with pytest.raises(LogError, match="no column 'UnixTimeSeconds'"):
        imported(tmp_path, 'a;b\n1;2\n')
    with pytest.raises(LogError, match='without any reading'):
        imported(tmp_path, 'UnixTimeSeconds;b\n1750000000;2\n')


@pytest.mark.parametrize('missing', ['-9999', '-9999.00', '-99', '0', '0.00', ''])
def test_what_stands_for_missing_is_no_reading(tmp_path, missing):
    cells = dict.fromkeys(('TWL_Depth', 'DOR_Depth_Prt', 'DOR_Depth_Std', 'DOR_Spread'), missing)
    done, found = imported(tmp_path, table(COLUMNS['2026'], [FIRST, FIRST | cells]))
    assert list(done.left_out) == [NO_READING]
    for topic in ('door/spread', 'sonar/pressure', 'door/port/pressure'):
        assert len(found[topic]) == 1
