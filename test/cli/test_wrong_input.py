"""Every command names a file that it cannot use, and what it expected in its place."""

import pytest

from trawl_ros.bags.writer import BagWriter
from trawl_ros.cli.main import COMMANDS

OUT = '{folder}/new'
OF_BAGS = (
    'bag info {path}',
    'bag check {path}',
    f'bag repair {{path}} --out {OUT}',
    f'bag export {{path}} --out {OUT}',
    f'bag export {{path}} --out {OUT} --as marport',
    'bag compare {path} sea_trial',
    f'identify {{path}} --steady --out {OUT}',
    f'diagnose {{path}} --out {OUT}',
    'swept {path}',
    'compare {path}',
    f'plot {{path}} --out {OUT}',
)
OF_GEARS = (
    'trim {path} --attack 16 --inclination 10',
    'plan-trial {path}',
    'gear check {path}',
    'gear state {path} --warp 400 --speed 2',
    f'gear copy {{path}} {OUT}',
    'gear set-door {path} flat_wooden --warp 400 --speed 2',
    'gear import {path}',
    f'identify sea_trial --steady --gear {{path}} --out {OUT}',
    'bag compare sea_trial sea_trial --gear {path}',
    f'missing-effect make {OUT} --seed 1 --trials 1 --gear {{path}}',
)
OF_TRIALS = (
    f'missing-effect answer {{path}} --out {OUT}',
    f'missing-effect score {{path}} answers.json --out {OUT}',
)
OF_SCENARIOS = (
    f'tow {{path}} --out {OUT}',
    f'identify sea_trial --steady --truth {{path}} --out {OUT}',
)
OF_LOGS = (
    f'import-log {{path}} --mapping nmea --out {OUT}',
    f'import-log {{path}} --mapping notus --out {OUT}',
    'import-log {path} --draft',
    'import-log {path}',
    f'compare {{path}} --mapping nmea --gear kaifuha --out {OUT}',
)


@pytest.fixture
def refused(run, tmp_path):
    """Run a command on a path; it ends with an error that names the path and what was expected."""

    def check(command, path):
        done = run(*command.format(path=path, folder=tmp_path).split())
        assert done.exit_code in (1, 2), done.output
        assert path.name in done.stderr
        assert 'expected' in done.stderr or 'Usage' in done.stderr
        assert 'Traceback' not in done.output
        assert not (tmp_path / 'new').exists()
        return done.stderr

    return check


@pytest.mark.parametrize('command', OF_BAGS + OF_GEARS + OF_SCENARIOS + OF_LOGS)
def test_a_missing_file(refused, tmp_path, command):
    refused(command, tmp_path / 'absent.yaml')


@pytest.mark.parametrize('command', OF_BAGS + OF_GEARS + OF_SCENARIOS + OF_LOGS + OF_TRIALS)
def test_an_empty_folder(refused, tmp_path, command):
    (tmp_path / 'hollow').mkdir()
    refused(command, tmp_path / 'hollow')


@pytest.mark.parametrize('command', OF_BAGS + OF_GEARS + OF_SCENARIOS + OF_LOGS)
def test_an_empty_file(refused, tmp_path, command):
    path = tmp_path / 'hollow.mcap'
    path.touch()
    refused(command, path)


@pytest.mark.parametrize('command', OF_BAGS + OF_GEARS + OF_SCENARIOS)
def test_a_text_that_is_something_else(refused, tmp_path, command):
    path = tmp_path / 'letter.mcap'
    path.write_text('Dear reader,\nthis is: no [bag\n')
    refused(command, path)


@pytest.mark.parametrize('topic', ['/chatter', '/trawl/truth/note', None])
@pytest.mark.parametrize('command', [words for words in OF_BAGS[4:] if 'bag' not in words])
def test_a_bag_without_readings(refused, tmp_path, command, topic):
    path = tmp_path / 'chat'
    with BagWriter(path) as bag:
        if topic is not None:
            bag.write(topic, 'std_msgs/msg/String', b'\0\1\0\0\3\0\0\0hi\0', 0)
    assert 'trawl bag' in refused(command, path)


def test_a_folder_of_bags_names_one_of_them(refused, tmp_path):
    (tmp_path / 'logs' / 'monday').mkdir(parents=True)
    (tmp_path / 'logs' / 'monday' / 'metadata.yaml').touch()
    assert 'monday' in refused('bag info {path}', tmp_path / 'logs')


@pytest.mark.parametrize(
    ('words', 'meant'),
    [
        ('identfy', 'identify'),
        ('import_log', 'import-log'),
        ('bag inf', 'info'),
        ('identify sea_trial --steddy', '--steady'),
        ('bag info sea_trail', 'sea_trial'),
        ('tow shakdown --out new', 'shakedown'),
        ('gear check kaifhua', 'kaifuha'),
    ],
)
def test_a_misspelt_name_brings_the_right_one(run, words, meant):
    done = run(*words.split())
    assert done.exit_code in (1, 2)
    assert meant in done.stderr


def test_an_unknown_command_brings_all(run):
    done = run('xyz')
    assert done.exit_code == 2
    assert all(name in done.stderr for name in COMMANDS)
