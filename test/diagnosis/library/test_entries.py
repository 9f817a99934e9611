"""The library of hypotheses: its tree, base rates, and rows that a user adds."""

import numpy as np
import pytest

from trawl_ros.core.errors import TrawlError
from trawl_ros.diagnosis.library.entries import library
from trawl_ros.diagnosis.library.table import hypothesis_table
from trawl_ros.effects.registry import catalogue
from trawl_ros.gear.load import load_gear


@pytest.fixture(scope='module')
def entries():
    return library(load_gear('kaifuha'))


def test_names_are_given_once_and_each_node_has_a_check_and_a_reason(entries):
    names = [entry.name for entry in entries]
    assert len(set(names)) == len(names)
    assert all(entry.check and entry.node.reason for entry in entries)


def test_entries_of_a_node_share_its_rate(entries):
    by_node = {}
    for entry in entries:
        by_node.setdefault(entry.node.path, []).append(entry.rate)
    rates = {node.path: node.rate / 100.0 for node in hypothesis_table().nodes}
    for path, own in by_node.items():
        assert np.sum(own) == pytest.approx(rates[path])
    assert sum(map(sum, by_node.values())) < 1.0


def test_all_effects_that_steady_tows_show_are_hypotheses(entries):
    there = {entry.effect.name for entry in entries}
    assert {name for name, effect in catalogue().items() if effect.fitted} <= there
    assert {'current_profile_along', 'empirical_port_tension_scale', 'both_pitch_drift'} <= there


def test_an_effect_that_is_not_possible_is_no_hypothesis():
    fewer = {name: own for name, own in catalogue().items() if name != 'bottom_contact'}
    names = {entry.name for entry in library(load_gear('kaifuha'), fewer)}
    assert 'bottom_contact' not in names
    assert 'board_rigging' in names


ROW = 'entries:\n  - {name: %s, at: mouth/weight, keys: [%s], usual: 0.1, low: -0.5, high: 0.5}\n'


def test_a_row_of_a_user_is_a_hypothesis_more(tmp_path):
    path = tmp_path / 'own.yaml'
    path.write_text(ROW % ('sand', 'clump.weight_in_water_n'))
    (own,) = [entry for entry in library(load_gear('kaifuha'), None, path) if entry.name == 'sand']
    assert own.node.path == 'mouth/weight'


@pytest.mark.parametrize(
    ('text', 'told'),
    [
        (ROW % ('twine', 'clump.weight_in_water_n'), 'found twine twice'),
        ('entries:\n  - {name: sand, at: the moon}\n', 'found the moon, expected'),
        ('entries:\n  - {name: one, at: mouth/weight, heigh: 1.0}\n', 'heigh'),
    ],
)
def test_a_wrong_row_is_refused(tmp_path, text, told):
    path = tmp_path / 'own.yaml'
    path.write_text(text)
    with pytest.raises(TrawlError, match=rf'own\.yaml: .*{told}'):
        hypothesis_table(path)


def test_an_effect_that_there_is_not_is_refused(tmp_path):
    path = tmp_path / 'own.yaml'
    path.write_text('entries:\n  - {name: sand, at: mouth/weight}\n')
    with pytest.raises(TrawlError, match='found sand, expected an effect'):
        library(load_gear('kaifuha'), None, path)
