"""The policy of a secured graph gives each node what it needs, and commands to few."""

from importlib.metadata import distribution
from xml.etree import ElementTree

import pytest
from click.testing import CliRunner

from trawl_ros.cli.policy import command
from trawl_ros.core.resources import share_path
from trawl_ros.records.permissions import policy
from trawl_ros.records.rights import NODE_RIGHTS, OPERATOR, SET_POINTS
from trawl_ros.records.topics import COMMANDS, SYNC, TOPICS


def granted(namespace: str, kind: str) -> dict[str, set[str]]:
    """Names that the policy grants in a way, by enclave."""
    root = ElementTree.fromstring(policy(namespace))
    return {
        str(enclave.get('path')): {
            str(name.text)
            for granted in enclave.iter()
            if granted.get(kind) == 'ALLOW'
            for name in granted
        }
        for enclave in root.iter('enclave')
    }


def test_the_file_that_ships_is_what_the_command_prints() -> None:
    printed = CliRunner().invoke(command, []).stdout
    assert share_path('config', 'sros2', 'policy.xml').read_text() == printed


def test_every_node_of_the_package_has_rights() -> None:
    programs = {
        entry.name
        for entry in distribution('trawl_ros').entry_points
        if entry.group == 'console_scripts'
    }
    assert set(NODE_RIGHTS) == programs - {'trawl'}


def test_nobody_but_controllers_set_points_and_an_operator_commands() -> None:
    commands = {topic.name for topic in COMMANDS}
    may = {path for path, names in granted('trawl', 'publish').items() if names & commands}
    nodes = ('autotrawl_node', 'autopilot_node', 'trial_node', SET_POINTS, OPERATOR)
    assert may == {f'/trawl/{node}' for node in nodes}


def test_no_instrument_sees_what_is_to_be_estimated() -> None:
    heard = granted('trawl', 'subscribe')
    for estimator in ('identification_node', 'discrepancy_node', 'autotrawl_node'):
        assert not [name for name in heard[f'/trawl/{estimator}'] if name.startswith('truth/')]


def test_topics_are_those_of_the_table() -> None:
    of_ros = {'/rosout', '/parameter_events', SYNC}
    for kind in ('publish', 'subscribe'):
        assert set().union(*granted('trawl', kind).values()) <= set(TOPICS) | of_ros


def test_enclaves_and_services_follow_the_namespace() -> None:
    paths = granted('fleet/one', 'reply')
    assert set(paths) == {f'/fleet/one/{node}' for node in (*NODE_RIGHTS, SET_POINTS, OPERATOR)}
    assert 'winch_node/set_parameters' in granted('fleet/one', 'request')[f'/fleet/one/{OPERATOR}']


@pytest.mark.parametrize('namespace', ['', 'a b', '1st', '"><policy>'])
def test_what_is_no_namespace_is_refused(namespace: str) -> None:
    outcome = CliRunner().invoke(command, ['--namespace', namespace])
    assert outcome.exit_code == 2
    assert 'expected a namespace' in outcome.output
