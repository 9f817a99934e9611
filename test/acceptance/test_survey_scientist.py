"""The way of a survey scientist in an empty folder: own bags, of another namespace."""

import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner

from trawl_ros.bags.writer import BagWriter
from trawl_ros.cli.main import trawl
from trawl_ros.messages.cdr import serialize
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.records.topics import absolute


@pytest.fixture(scope='module')
def foreign_bag(steady_tow, tmp_path_factory) -> Path:
    """A bag of another ship's namespace."""
    path = tmp_path_factory.mktemp('foreign') / 'bag'
    with BagWriter(path) as bag:
        for sample in steady_tow.samples():
            topic, message = sample_message(sample)
            name = absolute(topic, 'vessel_b')
            bag.write(name, message.__msgtype__, serialize(message), sample.stamp)
    return path


@pytest.mark.parametrize('words', ['identify bag --out out', 'compare bag', 'swept bag'])
def test_a_bag_of_another_namespace_says_which_one(foreign_bag, tmp_path, monkeypatch, words):
    monkeypatch.chdir(tmp_path)
    shutil.copytree(foreign_bag, 'bag')
    done = CliRunner().invoke(trawl, words.split())
    assert done.exit_code == 1
    assert '--namespace vessel_b' in done.stderr


def test_swept_areas_take_the_namespace_that_was_said(foreign_bag, coarse_gear):
    words = ['swept', str(foreign_bag), '--gear', str(coarse_gear), '--namespace', 'vessel_b']
    done = CliRunner().invoke(trawl, words)
    assert done.exit_code == 0, done.output
    assert 'area between the doors' in done.stdout
    assert 'speed over ground taken from that through the water' in done.stdout
