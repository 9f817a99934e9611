"""Blind trials are made of plants that can be towed, and hide what their keys say."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.lab.missing_effect.trials_folder import read_windows, write_windows
from trawl_ros.lab.trials.hidden_effects.inside import INSIDE
from trawl_ros.lab.trials.hidden_effects.on_deck import ON_DECK
from trawl_ros.lab.trials.hidden_effects.other_keys import CAUSES
from trawl_ros.lab.trials.hidden_effects.outside import OUTSIDE
from trawl_ros.lab.trials.making import likelihood_of, make
from trawl_ros.lab.trials.plant import FINER_MESH, draw_plant
from trawl_ros.lab.trials.tows import FULL_PLAN
from trawl_ros.lab.trials.trial import Spec
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.stability import stability

SEED = 5
EITHER_WAY = replace(FULL_PLAN, tows=FULL_PLAN.tows[: FULL_PLAN.baseline + 2])
"""The baseline, and one examined tow on either course."""


@pytest.fixture(scope='module')
def plant():
    return draw_plant('kaifuha', FINER_MESH, SEED, 0)


def looks(plant, hidden):
    """Observables of all states of the tows."""
    return np.array([[look.values for look in tow] for tow in plant.towed(hidden, EITHER_WAY)])


@pytest.fixture(scope='module')
def clean(plant):
    return looks(plant, ())


@pytest.mark.parametrize(
    'name',
    [
        *INSIDE,
        *OUTSIDE,
        *list(ON_DECK)[:3],
        *(pytest.param(name, marks=pytest.mark.slow) for name in list(CAUSES)[3:]),
    ],
)
def test_what_is_hidden_shows_in_examined_tows_alone(plant, clean, name):
    hidden = {**INSIDE, **OUTSIDE, **CAUSES}[name](np.random.default_rng(3))
    there = looks(plant, [(hidden, 1.0 * hidden.probe)])
    nothing = looks(plant, [(hidden, 0.0)])
    scale = np.abs(clean).max(axis=(0, 1))
    changed = np.abs(there - clean) / scale
    assert not changed[: EITHER_WAY.baseline].any()
    # Cells of sides that pull alike show nothing when they are swapped; the gear has no floats.
    shown = name not in ('board_stall', 'cells_swapped', 'floats_gone')
    if shown or (name == 'board_stall' and _stalls(clean)):
        assert changed[EITHER_WAY.baseline :].max() > 1e-4
    np.testing.assert_allclose(nothing / scale, clean / scale, atol=1e-5)


def _stalls(clean):
    return clean[..., OBSERVABLES.index('port_attack')].max() > np.radians(16.0)


def test_a_trial_is_the_same_wherever_it_is_made_and_its_strength_is_in_its_key():
    spec = Spec('inside', 3, ('spread_sensor',), 3.0, (-1.0,), 0)
    key, made = make(spec, 'kaifuha', FINER_MESH, SEED)
    again, same = make(spec, 'kaifuha', FINER_MESH, SEED)
    assert key == again
    assert made == same
    assert key.sizes[0] == pytest.approx(-3.0 * key.detectable[0])
    assert len(made) == sum(len(tow.states) for tow in FULL_PLAN.tows)
    twice, _ = make(replace(spec, strength=6.0), 'kaifuha', FINER_MESH, SEED)
    assert twice.detectable == key.detectable


def test_what_is_not_possible_is_not_testable():
    spec = Spec('inside', 4, ('warp_strumming',), 6.0, (-1.0,), 0)
    key, made = make(spec, 'kaifuha', FINER_MESH, SEED)
    assert made is None
    assert not key.testable
    assert 'warp_strumming' in key.why_not


def test_a_plant_is_stable_in_all_its_states():
    # Of the first boards of this number long warps are stable; at 300 m and 2 m/s they lean over
    # by a factor e in 14 s.
    drawn = draw_plant('kaifuha', FINER_MESH, 48, 4)
    for clean in drawn.clean.values():
        assert stability(drawn.model, clean.state.state, clean.state.tow).stable


@pytest.mark.slow
def test_what_tips_the_gear_over_is_neither_towed_nor_detectable(plant):
    heavy = INSIDE['cross_current'](np.random.default_rng(0))
    with pytest.raises(NoSteadyState):
        plant.towed([(heavy, 1.5)], FULL_PLAN)
    likely = likelihood_of('kaifuha', FINER_MESH, SEED, 0, 'full')
    # Nothing shows of it until it tips the gear.
    hidden = replace(
        heavy, name='tips', most=(0.0, 2.0), probe=1.5,
        gear=lambda size, model, at: heavy.gear(1.5, model, at) if size > 0.3 else model,
        shown=lambda size, shown, at: shown | {'door_spread': shown['door_spread'] + 1e-3 * size},
    )  # fmt: skip
    assert likely.detectable(hidden, 1.0, after_catalogue=False) == np.inf


def test_swapped_doors_are_there_or_not():
    spec = Spec('deck', 5, ('doors_swapped',), 3.0, (1.0,), 0)
    key, _ = make(spec, 'kaifuha', FINER_MESH, SEED)
    assert key.sizes == (1.0,)
    weak, made = make(replace(spec, strength=1.1 / key.detectable[0]), 'kaifuha', FINER_MESH, SEED)
    assert made is None
    assert 'is not possible' in weak.why_not


def test_windows_survive_their_file(tmp_path):
    _, windows = make(Spec('clean', 0, (), 0.0, (), 0), 'kaifuha', FINER_MESH, SEED)
    write_windows(tmp_path / 'a.json', windows)
    assert read_windows(tmp_path / 'a.json') == windows
    text = (tmp_path / 'a.json').read_text()
    assert not any(word in text for word in ('seed', 'plant', 'size', 'effect'))
