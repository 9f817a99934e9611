"""What an effect changes after its onset is what it will change, less a part that fades."""

import numpy as np
import pytest

from trawl_ros.diagnosis.onset.candidates import WATCHED, candidate_table
from trawl_ros.diagnosis.onset.gear import WatchedGear
from trawl_ros.diagnosis.onset.responses import onset_responses
from trawl_ros.effects.effect_set import NO_EFFECTS
from trawl_ros.effects.registry import catalogue
from trawl_ros.gear.load import load_gear
from trawl_ros.model.gear_model import build_model

FEW = {name: catalogue()[name] for name in ('tension_cell', 'net_drag', 'catch_build_up')}


@pytest.fixture(scope='module')
def table():
    return candidate_table(FEW)


def test_a_cell_shows_its_error_at_once_and_the_gear_takes_minutes(coarse_gear, table):
    onset_gear = load_gear(coarse_gear)
    gear = WatchedGear(build_model(onset_gear), NO_EFFECTS, table.at_one_hour())
    responses = onset_responses(
        gear, onset_gear.board.coefficients.array(), np.array([420.0, 420.0, 2.2]), 60
    )
    names = [f'{effect.name} {own.name}' for effect in table.effects for own in effect.parameters]
    cell, drag = names.index('tension_cell scale'), names.index('net_drag factor')
    depth = WATCHED.index('net_depth')
    assert not responses.fading[:, :, cell].any()
    left = np.abs(responses.fading[:, depth, drag])
    assert left[0] > left[10] > 1.3 * left[19] > 0.0
    assert left[10] > 0.5 * left[0], 'five minutes later most of it is still missing'
    assert np.abs(responses.fading[59]).max() < np.abs(responses.fading[19]).max()
    lasting = np.ones((len(WATCHED), len(names)))
    grown = responses.since(lasting, np.array([19]), table.growing.astype(float))
    scale = names.index('counters_drift rate') if 'counters_drift rate' in names else -1
    assert (responses.applied[:, drag] == 1.0).all()
    assert scale < 0 or responses.applied[0, scale] < 0.2
    catch = names.index('catch_build_up drag_area')
    missing = responses.fading[:20, depth, catch]
    expected = (19.5 - np.sum(missing) + 0.5 * missing[-1]) * 30.0 / 3600.0
    assert grown[0, depth, catch] == pytest.approx(expected)


def test_offsets_and_drifts_of_each_channel_and_of_both_sides_are_looked_for(table):
    names = [candidate.name for candidate in table.candidates]
    assert {'port_tension_offset', 'both_tension_drift', 'counters_drift', 'log_drift'} <= set(
        names
    )
    assert 'counters_offset' not in names, 'that is an effect of the catalogue'
    assert not any('opening' in name for name in names)
    assert len(names) == len(set(names))
