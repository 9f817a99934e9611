"""A command line that means nothing ends every node in one sentence."""

from importlib import import_module

import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

NODES = (
    'sim_node',
    'winch_node',
    'door_sensor_node',
    'trawl_sonar_node',
    'vessel_node',
    'autotrawl_node',
    'autopilot_node',
    'trial_node',
    'identification_node',
    'discrepancy_node',
    'bag_recorder',
    'bag_player',
    'nmea_in',
    'nmea_out',
    'foxglove_node',
)

FILES = {
    'unfinished.yaml': '/**: [\n',
    'flat.yaml': 'seed: 1\n',
    'mixed.yaml': '/**:\n  ros__parameters:\n    output: [1, a]\n',
    'binary.yaml': '\x00\x01\x02',
}

WRONG = {
    'remap without a target': ('-r foo', "'-r foo'"),
    'no remap': ('-r', '-r'),
    'namespace without its slash': ('-r __ns:=training', '__ns:=training'),
    'no node name': ('-r __node:=9!', '__node:=9!'),
    'parameter without a value': ('-p seed', "'-p seed'"),
    'parameter that is no YAML': ('-p output:=[', "'-p output:=['"),
    'clock that is no flag': ('-p use_sim_time:=maybe', 'use_sim_time'),
    'missing file': ('--params-file {folder}/none.yaml', 'none.yaml'),
    'no file': ('--params-file', '--params-file'),
    'folder as a file': ('--params-file {folder}', '{folder}'),
    **{name: (f'--params-file {{folder}}/{name}', name) for name in FILES},
    'log level': ('--log-level loud', '--log-level loud'),
    'enclave': ('--enclave x', 'nclave'),
    'unknown argument': ('--speed', '--speed'),
    'quality of service': (
        # Recorder and player ask for these two before.
        '-p output:=x -p bag:=x -p qos_overrides./diagnostics.publisher.reliability:=firm',
        'firm',
    ),
}


def told(node, words, capfd):
    """The exit code of a node, and what it says."""
    main = import_module(f'trawl_ros.nodes.{node}').main
    code = main([f'/somewhere/{node}', '--ros-args', *words.split()])
    return code, capfd.readouterr().err


@pytest.mark.parametrize(('words', 'culprit'), WRONG.values(), ids=WRONG)
@pytest.mark.parametrize('node', NODES)
def test_it_is_one_sentence_that_names_the_culprit(node, words, culprit, tmp_path, capfd):
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    code, errors = told(node, words.format(folder=tmp_path), capfd)
    assert code == 1
    assert errors.startswith(f'{node}: ')
    assert len(errors.splitlines()) == 1, errors
    assert culprit.format(folder=tmp_path) in errors
    assert 'expected' in errors
    assert '/project/' not in errors


def test_so_does_a_domain_that_is_none(monkeypatch, capfd):
    monkeypatch.setenv('ROS_DOMAIN_ID', 'abc')
    code, errors = told('winch_node', '-p seed:=1', capfd)
    assert (code, len(errors.splitlines())) == (1, 1)
    assert errors.startswith('winch_node: ROS 2 ')


def test_what_ros_says_of_itself_is_heard_again(capfd):
    told('winch_node', '-r foo', capfd)
    assert rclpy.logging.get_logger_level('rcl') == rclpy.logging.LoggingSeverity.UNSET
