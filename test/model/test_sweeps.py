"""Backstrops, a sweep and bridles that begin at its end."""

from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from trawl_ros.api.gear_check import BRIDLE_SUFFIXES
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.assembly import bar_tensions, forces, linearised, points_of
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.model.numerics import STEP
from trawl_ros.solver.equilibrium import SteadyState, steady_state

SWEEP = {'length_m': 59.0, 'upper_backstrop_m': 1.0, 'lower_backstrop_m': 1.0, 'segments': 4}


def forked(gear: GearRecord, **changes: Any) -> GearRecord:
    data = gear.model_dump(exclude={'board', 'bridles'})
    data['bridle']['length_m'] = 40.0
    return GearRecord.model_validate({**data, 'sweep': SWEEP, **changes})


@pytest.fixture(scope='module')
def model(pair_gear: GearRecord) -> GearModel:
    return build_model(forked(pair_gear))


@pytest.fixture(scope='module')
def steady(model: GearModel) -> SteadyState:
    return steady_state(model, 300.0, 1.4)


def test_ropes_run_from_plate_to_backstrops_to_sweep_to_bridles(model: GearModel) -> None:
    lines = {name: points for name, points, _ in model.layout.lines}
    for side, sweep in zip(('port', 'starboard'), model.layout.sweeps, strict=True):
        assert lines[f'{side}_sweep'].tolist() == sweep.tolist()
        for end, point in (('upper', 1), ('lower', 2)):
            backstrop = lines[f'{side}_{end}_backstrop']
            first = model.nodes + 3 * (side == 'starboard') + point
            assert backstrop.tolist() == [first, sweep[0]]
            assert lines[f'{side}_{end}_bridle'][0] == sweep[-1]
    assert model.gear.behind_boards == 100.0


def test_the_sweep_pulls_as_hard_as_the_bridles_behind_it(
    model: GearModel, steady: SteadyState
) -> None:
    found = steady.equilibrium
    tension = bar_tensions(model, found.state, found.tow)
    points = points_of(model, found.state, found.tow).positions
    pull = {}
    for name, ends, bars in model.layout.lines:
        if name.startswith('port') and name.endswith(BRIDLE_SUFFIXES):
            bar, way = (bars[-1], -1) if name.endswith('_sweep') else (bars[0], 1)
            a, b = (ends[-2], ends[-1]) if way < 0 else (ends[0], ends[1])
            along = (points[b] - points[a]) / np.linalg.norm(points[b] - points[a])
            pull[name] = tension[bar] * along
    bridles = pull['port_upper_bridle'] + pull['port_lower_bridle']
    # But for half of the weight and drag of three bars.
    assert pull['port_sweep'] == pytest.approx(bridles, abs=0.02 * np.linalg.norm(bridles))


def test_bridles_that_fork_behind_a_sweep_open_the_mouth_less(
    steady: SteadyState, pair_gear: GearRecord
) -> None:
    plain = steady_state(build_model(pair_gear), 300.0, 1.4).observables
    assert steady.observables.vertical_opening < 0.9 * plain.vertical_opening


def test_slopes_are_those_of_the_forces(model: GearModel, steady: SteadyState) -> None:
    found = steady.equilibrium
    step = np.random.default_rng(6).normal(size=model.dof)
    exact = forces(model, found.state.moved(1j * STEP * step), found.tow).imag / STEP
    slope = -model.pattern.times(linearised(model, found.state, found.tow).stiffness, step)
    assert np.abs(slope - exact).max() < 1e-9 * np.abs(exact).max()


def test_weights_hang_on_sweeps(pair_gear: GearRecord) -> None:
    weight = {'name': 'chain', 'rope': 'sweep', 'weight_in_water_n': 500.0}
    with_it = build_model(forked(pair_gear, hung=(*pair_gear.model_dump()['hung'], weight)))
    more = with_it.lump_mass - build_model(forked(pair_gear)).lump_mass
    for sweep in with_it.layout.sweeps:
        sunk = more[sweep].sum() * (1.0 - with_it.water.density / 7800.0)
        assert sunk * with_it.water.gravity == pytest.approx(500.0)


def test_a_finer_gear_has_finer_sweeps(model: GearModel) -> None:
    fine = build_model(model.gear.refined(bridle=3))
    assert len(fine.layout.sweeps[0]) - 1 == 3 * (len(model.layout.sweeps[0]) - 1)


@pytest.mark.parametrize(
    ('changes', 'expected'),
    [
        (
            {'bridles': ({'name': 'upper', 'at_board': 'upper', 'at_net': 'upper'},)},
            r'bridles\[0\].at_board: found upper',
        ),
        (
            {'bridles': ({'name': 'upper', 'at_net': 'upper'},)},
            'bridles: .*at_net lower',
        ),
        (
            {'sweep': None, 'bridles': ({'name': 'upper', 'at_net': 'upper'},)},
            r'bridles\[0\].at_board: missing',
        ),
    ],
)
def test_bridles_begin_either_at_boards_or_at_the_sweep(
    changes: dict[str, Any], expected: str, pair_gear: GearRecord
) -> None:
    with pytest.raises(ValidationError, match=expected):
        forked(pair_gear, **changes)
