"""`trawl view --live` becomes the node, with what was asked for as its parameters."""

import os

import pytest
from click.testing import CliRunner

from trawl_ros.cli import view
from trawl_ros.cli.main import trawl


class Become(Exception):
    """In place of another program."""


@pytest.fixture
def became(monkeypatch):
    def become(program, words):
        raise Become(words)

    monkeypatch.setattr(os, 'execv', become)

    def run(*arguments):
        done = CliRunner().invoke(trawl, ['view', *arguments])
        return done.exception.args[0] if isinstance(done.exception, Become) else done

    return run


def test_it_hands_on_what_was_asked_for(became):
    pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')
    words = became('--live', '--web', '--port', '9090', '--namespace', '/fleet/one/')
    assert 'view_node' in words[2]
    after = words[words.index('--ros-args') :]
    assert {'__ns:=/fleet/one', 'viewer:="web"', 'port:=9090', 'host:="127.0.0.1"'} <= set(after)


def test_without_ros_it_says_what_to_install(became, monkeypatch):
    monkeypatch.setattr(view, 'find_spec', lambda name: None)
    done = became('--live')
    assert done.exit_code == 1
    assert 'rclpy' in done.stderr


@pytest.mark.parametrize('arguments', [(), ('--live', 'a_bag')])
def test_it_wants_bags_or_the_graph(became, arguments):
    done = became(*arguments)
    assert done.exit_code == 2
    assert 'BAG... and --live: ' in done.stderr


def test_without_rerun_it_says_what_to_install(monkeypatch):
    import builtins
    import sys

    real = builtins.__import__

    def without(name, *rest):
        if name.partition('.')[0] == 'rerun':
            raise ModuleNotFoundError(name=name)
        return real(name, *rest)

    loaded = [name for name in sys.modules if name.startswith('trawl_ros.view')]
    for name in loaded:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setattr(builtins, '__import__', without)
    done = CliRunner().invoke(trawl, ['view', 'bags/sea_trial', '--out', 'nothing.rrd'])
    assert done.exit_code == 1
    assert "pip install 'trawl_ros[view]'" in done.stderr
