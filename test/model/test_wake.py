"""Wakes of netting: limits that are known, and what slope and solidity do."""

import numpy as np
import pytest

from trawl_ros.gear.load import load_gear
from trawl_ros.gear.netting import NettingRecord, SectionRecord
from trawl_ros.lab.validation.panels.netting import panel_loads
from trawl_ros.lab.validation.panels.published import netting_of
from trawl_ros.model.gear_model import build_model
from trawl_ros.model.net.wake import (
    KINEMATIC_VISCOSITY_M2_S,
    exposure,
    exposure_of,
    sheet,
    slowed,
    viscous,
)

ANGLE = np.pi / 4


@pytest.fixture(scope='module')
def net() -> NettingRecord:
    return load_gear('krill_800').netting


def panel(solidity: float, *, knotless: bool = True, square: bool = False) -> SectionRecord:
    return netting_of(solidity, 2e-3, knotless, square)


def test_across_the_flow_a_sheet_is_a_porous_screen(net: NettingRecord) -> None:
    # Taylor 1944: 1 / (1 + K / 4) of the speed is left, K on the speed between the twines.
    still = net.model_copy(update={'wake_exchange': 0.0})
    solidity = 0.25
    flat = sheet(panel(solidity), still, ANGLE, 0.5 * np.pi)
    resistance = still.normal_drag * solidity / (1.0 - solidity) ** 2
    expected = 1.0 / (1.0 + resistance / 4.0) / (1.0 - solidity)
    assert slowed(still, flat)[2] == pytest.approx(expected, rel=1e-6)


def test_thin_netting_has_the_drag_of_its_single_twines(net: NettingRecord) -> None:
    left = exposure_of(sheet(panel(0.001), net, ANGLE, 0.2), net)
    assert left.normal == pytest.approx(1.0, abs=0.01)
    assert left.friction == pytest.approx(1.0, abs=0.01)


def test_denser_netting_and_flatter_slopes_have_longer_wakes(net: NettingRecord) -> None:
    def left(solidity: float, slope: float) -> float:
        return exposure_of(sheet(panel(solidity), net, ANGLE, slope), net).normal

    assert left(0.3, 0.05) < left(0.1, 0.05) < 1.0
    assert left(0.2, 0.02) < left(0.2, 0.1) < left(0.2, 0.3)


def test_knots_hide_their_twine(net: NettingRecord) -> None:
    section = panel(0.01, knotless=False)
    hidden = 2.0 * net.knot_diameters * section.twine_diameter_m / section.mesh_m
    left = exposure_of(sheet(section, net, ANGLE, 0.2), net)
    bare = exposure_of(sheet(panel(0.01), net, ANGLE, 0.2), net)
    assert left.normal / bare.normal == pytest.approx(1.0 - hidden, rel=0.01)


def test_a_file_may_give_the_shielding_itself(net: NettingRecord) -> None:
    section = panel(0.3).model_copy(update={'shielding': 0.7})
    left = exposure(section, net)
    assert (left.normal, left.friction, left.knots) == (0.7, 0.7, 0.7)


def test_netting_without_shielding_has_the_drag_of_its_single_twines() -> None:
    gear = load_gear('krill_800')
    net = gear.netting
    assert net.plan is not None
    bare = net.model_copy(update={'plan': net.plan.model_copy(update={'shielded': False})})
    plain, single = (
        build_model(gear.model_copy(update={'netting': one}).refined(net=0.4))
        for one in (net, bare)
    )
    assert np.all(single.bars.normal_drag >= plain.bars.normal_drag)
    assert np.sum(single.lump_drag_area) > 1.1 * np.sum(plain.lump_drag_area)


def test_coefficients_grow_with_the_root_of_the_reynolds_number(net: NettingRecord) -> None:
    speed, diameter = 0.5, 1.5e-3
    across, along = viscous(net, diameter)
    reynolds = speed * diameter / KINEMATIC_VISCOSITY_M2_S
    assert net.normal_drag * across / np.sqrt(speed) == pytest.approx(4.0 / np.sqrt(reynolds))
    # Along, π μ 0.55 Re^1/2 U_t per length is ½ ρ π d C_f U_t².
    expected = 2.0 * 0.55 * np.sqrt(reynolds) * KINEMATIC_VISCOSITY_M2_S / diameter
    assert net.friction * along * np.sqrt(speed) == pytest.approx(expected)
    assert viscous(net.model_copy(update={'viscous': 0.0}), diameter) == (0.0, 0.0)


def test_a_panel_across_the_flow_has_drag_alone(net: NettingRecord) -> None:
    drag, lift, knots = panel_loads(panel(0.2, square=True), net, ANGLE, 0.5 * np.pi, 0.7)
    assert 1.2 < drag < 1.6
    assert lift == pytest.approx(0.0, abs=1e-12)
    assert knots == 0.0
