"""Shielding of netting lies between two bounds: water slowed across its sheet only, and wakes that
nothing but the water through the sheet carries away.
"""

from collections.abc import Iterator

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.netting import SectionRecord
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.model.net.planned_cloth import PlannedCloth
from trawl_ros.model.net.planned_mouth import PlannedMouth
from trawl_ros.model.net.rows import rows_of
from trawl_ros.model.state import State
from trawl_ros.solver.equilibrium import steady_state


def load(
    section: SectionRecord, model: GearModel, angle: float, slope: float, slowed: FloatArray
) -> FloatArray:
    """Force per area of twine over ½ ρ U², (3,): along the sheet, around, across it.

    ``angle`` is that of the bars in the sheet, ``slope`` that of the sheet to the flow, ``slowed``
    the parts of the water's motion along the sheet and across it that are left.
    """
    net = model.gear.netting
    flow = np.array([slowed[0] * np.cos(slope), 0.0, slowed[1] * np.sin(slope)])
    knots = 0.0 if section.knotless else net.knot_drag * net.knot_diameters**2 * np.pi / 4
    knots *= section.twine_diameter_m / section.mesh_m
    force = knots * np.linalg.norm(flow) * flow
    for sign in (1.0, -1.0):
        bar = np.array([np.cos(angle), sign * np.sin(angle), 0.0])
        along = flow @ bar
        across = flow - along * bar
        force = force + 0.5 * net.normal_drag * np.linalg.norm(across) * across
        force = force + 0.5 * net.friction * np.pi * abs(along) * along * bar
    return force


def balanced(section: SectionRecord, model: GearModel, angle: float, slope: float) -> FloatArray:
    """Parts of the water's motion that are left where it gives up by its own momentum alone what
    the twines take: the mean of what comes to the sheet and what leaves it.
    """
    solidity = 4 * section.twine_diameter_m / (section.mesh_m * np.sin(2 * angle))
    slowed = np.ones(2)
    for _ in range(300):
        force = load(section, model, angle, slope, slowed)[[0, 2]] * solidity
        lost = force / (4 * slowed[1] * np.sin(slope)) / np.array([np.cos(slope), np.sin(slope)])
        slowed += 0.2 * (np.maximum(1.0 - lost, 0.05) - slowed)
    return slowed


def sheets(model: GearModel, state: State) -> Iterator[tuple[SectionRecord, float, float, float]]:
    """Section, area of twine (m²), angle of its bars and slope (rad) of every row of the body."""
    net = model.gear.netting
    assert net.plan is not None
    mouth = PlannedMouth(net.plan, net.around)
    body = PlannedCloth(net, mouth).bodies['upper']
    rows = rows_of(body, net.around, net.halved_at_circumference_m, mouth.corner)
    counts = [row.around for row in rows] + [rows[-1].columns]
    nodes = state.nodes[model.layout.net][: -net.codend_segments][-sum(counts) :]
    rings = np.split(nodes, np.cumsum(counts)[:-1])
    places = [ring[:, 0].mean() for ring in rings]
    round_about = [np.linalg.norm(np.roll(r, -1, 0) - r, axis=1).sum() for r in rings]
    for k, row in enumerate(rows):
        section, circumference = body.at(0.5 * (row.front + row.back))
        width = 0.5 * (round_about[k] + round_about[k + 1])
        narrowing = (round_about[k] - round_about[k + 1]) / (2 * np.pi)
        slope = np.arctan2(narrowing, abs(places[k + 1] - places[k]))
        area = body.per_mesh_column(row.front, row.back, row.columns)['area'] * 2 * row.columns
        yield section, area, np.arcsin(min(width / circumference, 1.0)), max(slope, 0.03)


def test_shielding_lies_between_water_slowed_across_the_sheet_and_wakes_along_it() -> None:
    gear = load_gear('krill_800')
    model = build_model(gear.refined(net=0.6))
    state = steady_state(model, 500.0, 1.2).equilibrium.state
    drag = dict.fromkeys(('single twines', 'slowed across', 'as built', 'wakes'), 0.0)
    for section, area, angle, slope in sheets(model, state):
        taylor = np.sqrt(section.shielding)
        wakes = balanced(section, model, angle, slope)
        flow = np.array([np.cos(slope), 0.0, np.sin(slope)])
        pressure = 0.5 * 1025.0 * 1.2**2 * area
        for name, slowed in (
            ('single twines', np.ones(2)),
            ('slowed across', np.array([1.0, taylor])),
            ('as built', np.array([taylor, taylor])),
            ('wakes', wakes),
        ):
            drag[name] += pressure * float(load(section, model, angle, slope, slowed) @ flow)
    print({name: f'{1e-3 * newtons:.1f} kN' for name, newtons in drag.items()})  # noqa: T201
    assert drag['slowed across'] > 0.98 * drag['single twines']
    assert drag['wakes'] < drag['as built'] < drag['slowed across']
    middle = 0.5 * (drag['wakes'] + drag['slowed across'])
    assert abs(drag['as built'] / middle - 1.0) < 0.1


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
