"""``trawl bag info`` and ``trawl import-log``."""

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
    assert 'storage mcap, metadata version 8, ROS jazzy, zstd per chunk' in done.stdout
    assert done.stderr == ''
    whole = (bag / 'bag_0.mcap').read_bytes()
    cut = tmp_path / 'cut.mcap'
    cut.write_bytes(whole[: len(whole) * 9 // 10])
    done = run('bag', 'info', cut)
    assert done.exit_code == 0
    assert f'Damaged: {cut}: ' in done.stderr
    assert 'cut short' in done.stderr


def test_info_on_an_empty_bag_and_on_none(run, tmp_path):
    with BagWriter(tmp_path / 'empty'):
        pass
    done = run('bag', 'info', tmp_path / 'empty')
    assert done.exit_code == 1
    assert f'{tmp_path / "empty"}: holds no message' in done.stderr
    assert run('bag', 'info', tmp_path / 'none').exit_code == 1


def test_the_door_tests_at_sea_become_a_bag_that_lacks_channels(run, log, tmp_path):
    bag = tmp_path / 'haul'
    done = run('import-log', log, '--mapping', 'door_test_haul_log', '--out', bag)
    assert done.exit_code == 0, done.output
    assert '104  /trawl/winch/joint_states' in done.stdout
    done = run('identify', bag, '--out', tmp_path / 'out')
    assert done.exit_code == 1
    for channel in ('speed from vessel/velocity_water', 'door_spread from door/spread'):
        assert channel in done.stderr
    assert 'nothing is estimated' in done.stderr
    assert run('import-log', log, '--mapping', 'door_test_haul_log', '--out', bag).exit_code == 1


def test_a_log_or_mapping_that_is_not_there(run, tmp_path):
    done = run(
        'import-log', tmp_path / 'a.csv', '--mapping', 'door_test_haul_log', '--out', tmp_path / 'b'
    )
    assert done.exit_code == 1
    assert f'{tmp_path / "a.csv"}: no such file' in done.stderr
    done = run('import-log', tmp_path / 'a.csv', '--mapping', 'none', '--out', tmp_path / 'b')
    assert done.exit_code == 1
    assert 'door_test_haul_log.yaml' in done.stderr
