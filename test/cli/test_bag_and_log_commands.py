"""``trawl bag info``, ``check`` and ``export``, and ``trawl import-log``."""

import json
import re
from pathlib import Path

import pytest

from trawl_ros.bags.writer import BagWriter

LOG = (
    Path(__file__).resolve().parents[3]
    / 'shared/data/noaa_trawlmetrics/gear_testing_2026_haul_log.csv'
)


@pytest.fixture
def log():
    if not LOG.is_file():
        pytest.skip(f'the door tests at sea are not here: {LOG}')
    return LOG


def test_info_counts_messages_and_says_what_is_damaged(run, steady_tow, tmp_path):
    bag = steady_tow.bag(tmp_path / 'bag', leg_s=20)
    done = run('bag', 'info', bag)
    assert done.exit_code == 0
    assert f'{bag}: 320 messages in 0.7 min' in done.stdout
    words = next(line for line in done.stdout.splitlines() if '/trawl/door/spread' in line).split()
    assert words[:2] == ['40', '1']
    assert words[4:] == ['sensor_msgs/msg/Range', 'reliable,', 'volatile,', 'last', '100']
    for part in ('storage mcap', 'version 8', 'ROS jazzy', 'zstd'):
        assert part in done.stdout
    assert done.stderr == ''
    whole = (bag / 'bag_0.mcap').read_bytes()
    cut = tmp_path / 'cut.mcap'
    cut.write_bytes(whole[: len(whole) * 9 // 10])
    done = run('bag', 'info', cut)
    assert done.exit_code == 0
    assert str(cut) in done.stderr


def test_info_on_an_empty_bag_and_on_none(run, tmp_path):
    with BagWriter(tmp_path / 'empty'):
        pass
    done = run('bag', 'info', tmp_path / 'empty')
    assert done.exit_code == 1
    assert str(tmp_path / 'empty') in done.stderr
    assert run('bag', 'info', tmp_path / 'none').exit_code == 1


def test_the_door_tests_at_sea_become_a_bag_that_lacks_channels(run, log, tmp_path):
    bag = tmp_path / 'haul'
    done = run('import-log', log, '--mapping', 'door_test_haul_log', '--out', bag)
    assert done.exit_code == 0, done.output
    assert '104  /trawl/winch/joint_states' in done.stdout
    done = run('identify', bag, '--out', tmp_path / 'out')
    assert done.exit_code == 1
    for topic in ('vessel/velocity_water', 'door/spread'):
        assert topic in done.stderr
    assert run('import-log', log, '--mapping', 'door_test_haul_log', '--out', bag).exit_code == 1


def test_a_log_or_mapping_that_is_not_there(run, tmp_path):
    done = run(
        'import-log', tmp_path / 'a.csv', '--mapping', 'door_test_haul_log', '--out', tmp_path / 'b'
    )
    assert done.exit_code == 1
    assert str(tmp_path / 'a.csv') in done.stderr
    (tmp_path / 'a.csv').write_text('a,b\n')
    done = run('import-log', tmp_path / 'a.csv', '--mapping', 'none', '--out', tmp_path / 'b')
    assert done.exit_code == 1
    assert 'door_test_haul_log' in done.stderr


def test_info_and_check_speak_to_scripts(run, steady_tow, tmp_path):
    bag = steady_tow.bag(tmp_path / 'bag', leg_s=20)
    done = run('bag', 'info', '--json', bag)
    told = json.loads(done.stdout)
    assert (told['count'], told['facts']['storage'], told['facts']['version']) == (320, 'mcap', 8)
    spread = next(topic for topic in told['topics'] if topic['topic'] == '/trawl/door/spread')
    assert (spread['count'], spread['rate']) == (40, 1.0)
    done = run('bag', 'check', '--json', bag)
    assert done.exit_code == 0
    told = json.loads(done.stdout)
    assert told['sound'] is True
    assert told['findings'] == []


def test_check_says_by_its_exit_code_whether_something_was_found(run, steady_tow, tmp_path):
    bag = steady_tow.bag(tmp_path / 'bag', leg_s=20)
    done = run('bag', 'check', bag)
    assert done.exit_code == 0, done.output
    assert 'of truth: all' in done.stdout
    done = run('bag', 'check', bag, '--require', 'vessel/fix')
    assert done.exit_code == 3
    assert '(missing): /trawl/vessel/fix' in done.stdout
    whole = (bag / 'bag_0.mcap').read_bytes()
    (bag / 'bag_0.mcap').write_bytes(whole[: len(whole) * 9 // 10])
    done = run('bag', 'check', bag)
    assert done.exit_code == 3
    assert 'bag_0.mcap' in done.stdout
    assert run('bag', 'check', tmp_path / 'none').exit_code == 1
    assert run('bag', 'check', bag, '--require', 'fish').exit_code == 1


def test_export_writes_tables_and_nothing_over(run, steady_tow, tmp_path):
    bag = steady_tow.bag(tmp_path / 'bag', leg_s=20)
    done = run('bag', 'export', bag, '--out', tmp_path / 'out', '--topic', 'door/spread')
    assert done.exit_code == 0, done.output
    file = tmp_path / 'out' / 'trawl.door.spread.csv'
    assert f'40 rows  {file}' in done.stdout
    assert len(file.read_text().splitlines()) == 41
    before = file.read_bytes()
    done = run('bag', 'export', bag, '--out', tmp_path / 'out')
    assert done.exit_code == 1
    assert str(file.parent) in done.stderr
    assert file.read_bytes() == before


def test_sentences_of_the_ship_become_a_bag(run, tmp_path):
    log = tmp_path / 'ship.nmea'
    log.write_text('$GPZDA,103850.00,01,08,2026,00,00*66\n$HEHDT,180.0,T*26\n$HEHDT,181.0,T*2B\n')
    done = run('import-log', log, '--mapping', 'nmea', '--out', tmp_path / 'bag')
    assert done.exit_code == 0, done.output
    assert f'{tmp_path / "bag"}: 1 messages from 3 lines' in done.stdout
    assert re.search(r'^ *1 .*checksum', done.stdout, re.MULTILINE)


def test_bad_rows_are_left_out_on_demand(run, tmp_path):
    (tmp_path / 'log.csv').write_text('t,p\n1,1\n2,much\n')
    mapping = tmp_path / 'mapping.yaml'
    mapping.write_text(
        'clock: {columns: [t], format: seconds}\n'
        'topics: {sonar/pressure: {fields: {pressure: {column: p, unit: bar}}}}\n'
    )
    arguments = ('import-log', tmp_path / 'log.csv', '--mapping', mapping, '--out', tmp_path / 'b')
    assert run(*arguments).exit_code == 1
    done = run(*arguments, '--leave-out')
    assert done.exit_code == 0, done.output
    assert re.search(r"^ *1 .*column 'p'.*bar", done.stdout, re.MULTILINE)
