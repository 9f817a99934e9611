"""Cold starts: nets of any fineness are found, and agree."""

import numpy as np
import pytest

from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.assembly import bar_tensions
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.model.observables import observe
from trawl_ros.solver.cold_start import bowed, cold_start, straightened
from trawl_ros.solver.operating_point import OperatingPoint, steady_tow
from trawl_ros.solver.relax import FORCE_TOLERANCE


def netting(gear: GearRecord, around: int, pressure: float = 0.0) -> GearModel:
    changes = {'around': around, 'bowing_pressure_pa': pressure}
    return build_model(gear.model_copy(update={'netting': gear.netting.model_copy(update=changes)}))


@pytest.mark.parametrize(
    ('around', 'length'),
    [
        (24, 500.0),
        (48, 150.0),
        (72, 200.0),
        *(pytest.param(n, 500.0, marks=pytest.mark.slow) for n in (96, 144)),
    ],
)
def test_nets_of_any_fineness_are_found(gear: GearRecord, around: int, length: float) -> None:
    model = netting(gear, around)
    tow = steady_tow(model, OperatingPoint(length, length, 2.1))
    _, _, residual = cold_start(model, 0.0, tow)
    assert residual < FORCE_TOLERANCE


def test_the_shape_does_not_depend_on_the_load_it_was_sought_with(model: GearModel, steady) -> None:
    found = steady.equilibrium
    shape, _, residual = straightened(model, found.state, found.tow)
    assert residual < FORCE_TOLERANCE
    np.testing.assert_allclose(shape.nodes, found.state.nodes, atol=1e-5)


def test_bowed_netting_pulls_everywhere_and_hardly_changes_the_gear(
    gear: GearRecord, model: GearModel, steady
) -> None:
    found = steady.equilibrium
    soft = netting(gear, model.gear.netting.around, 317.0)
    state, _, residual = cold_start(soft, 0.0, found.tow)
    assert residual < FORCE_TOLERANCE
    netted = soft.bars.bow > 0.0
    assert (bar_tensions(model, found.state, found.tow)[netted] == 0.0).any()
    assert (bar_tensions(soft, state, found.tow)[netted] > 0.0).all()
    spread, opening = (
        getattr(observe(soft, state, found.tow), name) / getattr(found.observables, name) - 1.0
        for name in ('door_spread', 'vertical_opening')
    )
    assert abs(spread) < 0.01
    assert -0.03 < opening < 0.0


def test_a_bow_of_the_gear_file_is_kept_by_the_cold_start(gear: GearRecord) -> None:
    soft = netting(gear, 12, 1e5)
    assert (bowed(soft, 1.0).bars.bow >= soft.bars.bow).all()


@pytest.mark.parametrize('around', [12, 24])
def test_the_load_on_twine_is_that_of_one_bar_from_knot_to_knot(
    gear: GearRecord, around: int
) -> None:
    # n bars of a mesh side by side, each with the load p d l: n p d l = p d times the row's length.
    model = netting(gear, around, 100.0)
    first = model.net_mesh.bars[0]
    number = int(np.flatnonzero(model.bars.bow)[0])
    load = model.bars.stiffness[number] * np.sqrt(24 * model.bars.bow[number])
    front = gear.netting.body[0]
    share = 0.5  # of a column, on a wing's edge
    assert load == pytest.approx(share * 100.0 * front.twine_diameter_m * first.rest)


def test_a_net_that_lies_nearly_flat_is_found_with_a_harder_load() -> None:
    # As in a flume tank at 1.8 m/s: with the first load alone 3 kN are left.
    tank = load_gear('flume_83_112')
    assert tank.pair is not None
    front = {'weight_in_water_n_m': 0.0, 'normal_drag': 0.0, 'tangential_drag': 0.0, 'segments': 2}
    flat = tank.model_copy(
        update={
            'pair': tank.pair.model_copy(update={'distance_m': 60.83}),
            'warp': tank.warp.model_copy(update=front),
            'footrope': tank.footrope.model_copy(update={'weight_in_water_n_m': 5.0}),
            'bridles': tuple(
                bridle.model_copy(update={'length_m': 55.51 if bridle.at_net == 'lower' else 54.9})
                for bridle in tank.bridles
            ),
        }
    )
    model = build_model(flat)
    _, _, residual = cold_start(model, 0.0, steady_tow(model, OperatingPoint(0.5, 0.5, 1.8)))
    assert residual < FORCE_TOLERANCE
