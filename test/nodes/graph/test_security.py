"""A node that is to be secure never runs in the clear without a word."""

import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from trawl_ros.nodes.graph import security  # noqa: E402
from trawl_ros.nodes.winch_node import main  # noqa: E402

pytestmark = pytest.mark.ros

KEYS = (
    'identity_ca.cert.pem',
    'cert.pem',
    'key.pem',
    'permissions_ca.cert.pem',
    'governance.p7s',
    'permissions.p7s',
)


@pytest.mark.parametrize(
    ('environment', 'warned'),
    [
        ({}, False),
        ({'ROS_SECURITY_ENABLE': 'false'}, False),
        ({'ROS_SECURITY_ENABLE': 'true'}, True),
        ({'ROS_SECURITY_ENABLE': 'true', 'ROS_SECURITY_STRATEGY': 'Permissive'}, True),
        ({'ROS_SECURITY_ENABLE': 'true', 'ROS_SECURITY_STRATEGY': 'Enforce'}, False),
    ],
)
def test_what_may_go_in_the_clear_is_told(environment, warned):
    assert (security.objection(environment) is not None) == warned


@pytest.fixture
def secured(monkeypatch, tmp_path):
    """Environment that asks for security, without any keys yet."""
    monkeypatch.setenv('ROS_SECURITY_ENABLE', 'true')
    monkeypatch.setenv('ROS_SECURITY_STRATEGY', 'Enforce')
    monkeypatch.setenv('ROS_SECURITY_KEYSTORE', str(tmp_path))
    return tmp_path


def refusal(capfd):
    """Return the one sentence with which a node ends that was to be secure."""
    code = main(['winch_node', '--ros-args', '--enclave', '/trawl/winch_node'])
    said = capfd.readouterr().err
    assert code == 1
    assert len(said.splitlines()) == 1, said
    assert said.startswith('winch_node: ROS 2 refuses to start: ')
    assert said.rstrip().endswith(security.EXPECTED)
    return said


def test_without_keys_it_ends_with_a_sentence(secured, capfd):
    assert f'{secured}/enclaves/trawl/winch_node' in refusal(capfd)


def test_without_a_keystore_too(secured, monkeypatch, capfd):
    monkeypatch.delenv('ROS_SECURITY_KEYSTORE')
    refusal(capfd)


def test_keys_that_nobody_signed_do_not_open_the_graph(secured, capfd):
    enclave = secured / 'enclaves/trawl/winch_node'
    enclave.mkdir(parents=True)
    for name in KEYS:
        (enclave / name).write_text('nobody')
    refusal(capfd)
