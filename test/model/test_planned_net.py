"""A net from its plan: twine, mirror image, ropes and rigging are those of the plan."""

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from trawl_ros.core.errors import GearError
from trawl_ros.core.resources import share_path
from trawl_ros.gear.findings import findings
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.net_plan import NetPlanRecord, PieceRecord, cut_slope
from trawl_ros.gear.netting import NettingRecord
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.model.net.planned_cloth import PlannedCloth, mesh_angle, section_of
from trawl_ros.model.net.planned_mouth import PlannedMouth
from trawl_ros.model.net.wake import Exposure, exposure
from trawl_ros.solver.equilibrium import steady_state

AROUND = (24, 36, 48)


def plan_data() -> dict[str, Any]:
    return yaml.safe_load(share_path('config', 'gear', 'krill_800.yaml').read_text())


def loaded(folder: Path, data: dict[str, Any]) -> GearRecord:
    path = folder / 'own.yaml'
    path.write_text(yaml.safe_dump(data))
    return load_gear(path)


@cache
def cut_to(gear: GearRecord, around: int) -> GearModel:
    """The gear with a net of so many meshes, which is made once for all claims about it."""
    netting = gear.netting.model_copy(update={'around': around})
    return build_model(gear.model_copy(update={'netting': netting}))


def plan_of(gear: GearRecord) -> NetPlanRecord:
    assert gear.netting.plan is not None
    return gear.netting.plan


def piece(part: str, panel: str, front: float, back: float, long: float, **more: Any) -> dict:
    return {
        'part': part,
        'panel': panel,
        'mesh_mm': 800.0,
        'front_meshes': front,
        'back_meshes': back,
        'long_meshes': long,
        'rtex': 3370.0,
        'material': 'PA',
        **more,
    }


TWO_PANELS = [
    piece('wing', 'upper', 20, 60, 40),
    piece('wing', 'lower', 20, 60, 40),
    piece('body', 'upper', 160, 60, 60, section='belly'),
    piece('body', 'lower', 160, 60, 60, section='belly'),
    piece('codend', 'all', 120, 100, 20, section='codend'),
]
WHOLE_SIDES = [
    piece('wing', 'upper', 10, 40, 30),
    piece('wing', 'side', 60, 60, 30),
    piece('wing', 'lower', 10, 40, 30),
    piece('body', 'upper', 110, 40, 60, section='belly'),
    piece('body', 'side', 60, 30, 60, section='belly'),
    piece('body', 'lower', 110, 40, 60, section='belly'),
    piece('codend', 'all', 140, 100, 20, section='codend'),
]
SQUARE = [
    piece('wing', 'upper', 10, 40, 30),
    piece('wing', 'upper', 110, 110, 18, pieces=1),
    piece('wing', 'side_upper', 10, 28, 48),
    piece('wing', 'side_lower', 10, 28, 48),
    piece('wing', 'lower', 10, 40, 48),
    *WHOLE_SIDES[3:],
]
SIX_PANELS = [
    *(row for row in SQUARE[:5]),
    piece('body', 'upper', 110, 40, 60, section='belly'),
    piece('body', 'side_upper', 40, 18, 60, section='belly'),
    piece('body', 'side_lower', 20, 12, 60, section='belly', rtex=6740.0),
    piece('body', 'lower', 110, 40, 60, section='belly'),
    piece('codend', 'all', 140, 100, 20, section='codend'),
]
ROPES = [
    piece('body', panel, count, count, 15, section='ropes', orientation='ropes')
    | {'rtex': None, 'twine_diameter_mm': 12.0}
    for panel, count in (('upper', 110), ('side', 60), ('lower', 110))
]
ROPE_FRONT = [*WHOLE_SIDES[:3], *ROPES, *WHOLE_SIDES[3:]]
NO_SIDE_WINGS = [SQUARE[0], SQUARE[4] | {'long_meshes': 30}, *WHOLE_SIDES[3:]]
PLANS = {
    'published': None,
    'two panels': TWO_PANELS,
    'whole sides': WHOLE_SIDES,
    'square': SQUARE,
    'no side wings': NO_SIDE_WINGS,
    'six panels': SIX_PANELS,
    'ropes ahead': ROPE_FRONT,
}


@pytest.fixture(scope='module', params=PLANS)
def gear(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> GearRecord:
    data = plan_data()
    if PLANS[request.param] is not None:
        data['netting']['plan']['pieces'] = PLANS[request.param]
        for rope in ('headrope', 'footrope', 'side_rope'):
            data.get(rope, {}).pop('length_m', None)
    return loaded(tmp_path_factory.mktemp('plan'), data)


@pytest.mark.parametrize('around', AROUND)
def test_twine_is_that_of_the_plan(gear: GearRecord, around: int) -> None:
    bars = cut_to(gear, around).net_mesh.bars
    area = sum(bar.area * bar.rest for bar in bars)
    assert area == pytest.approx(sum(p.twine_area for p in plan_of(gear).pieces), rel=0.02)


@pytest.mark.parametrize('around', AROUND)
def test_the_net_is_its_own_mirror_image(gear: GearRecord, around: int) -> None:
    mesh = cut_to(gear, around).net_mesh
    image = mesh.positions * [1.0, -1.0, 1.0]
    apart = np.linalg.norm(image[:, None] - mesh.positions[None], axis=2)
    assert apart.min(axis=1).max() < 1e-9
    twin = apart.argmin(axis=1)
    for rim in (mesh.headrope, mesh.footrope):
        np.testing.assert_array_equal(twin[rim], rim[::-1])
        assert len(rim) % 2 == 1
    np.testing.assert_array_equal(twin[mesh.wing_ends[0]], mesh.wing_ends[1])
    np.testing.assert_array_equal(twin[list(mesh.tips[:2])], mesh.tips[2:])
    np.testing.assert_allclose(mesh.knot_area[twin], mesh.knot_area, rtol=1e-9)


@pytest.mark.parametrize('around', AROUND)
def test_ropes_are_as_long_as_planned_however_fine_the_net(gear: GearRecord, around: int) -> None:
    model = cut_to(gear, around)
    bars: dict[str, list[int]] = {}
    for name, _, numbers in model.layout.lines:
        bars.setdefault(name, []).extend(numbers.tolist())
    for name, key in (
        ('headrope', 'headrope'),
        ('footrope', 'footrope'),
        ('port_wing_end', 'side_rope'),
        ('starboard_wing_end', 'side_rope'),
    ):
        record = getattr(gear, key)
        given = record.length_m if record is not None else None
        length = plan_of(gear).rope_length(key) if given is None else given
        assert model.rest[bars[name]].sum() == pytest.approx(length, rel=1e-9), name


@pytest.mark.parametrize('around', AROUND)
def test_every_node_of_the_frame_is_on_a_rope_and_hangs_on_netting(
    gear: GearRecord, around: int
) -> None:
    """The frame is one closed line around the mouth, along which neighbours are netting's."""
    mesh = cut_to(gear, around).net_mesh
    ring = [*mesh.headrope[:-1], *mesh.wing_ends[1][:-1], *mesh.footrope[:0:-1]]
    ring += mesh.wing_ends[0][:0:-1]
    assert len(set(ring)) == len(ring)
    assert mesh.headrope[0] == mesh.wing_ends[0][0] == mesh.tips[0]
    assert mesh.footrope[0] == mesh.wing_ends[0][-1] == mesh.tips[1]
    held = {bar.start for bar in mesh.bars} | {bar.end for bar in mesh.bars}
    assert set(range(len(mesh.positions))) == held


def test_wings_are_as_long_as_planned_as_near_as_rows_go(gear: GearRecord) -> None:
    mesh = cut_to(gear, 48).net_mesh
    plan = plan_of(gear)
    ahead = max(plan.wing_length('upper'), plan.wing_length('lower'))
    mouth = -mesh.positions[mesh.headrope[len(mesh.headrope) // 2]][0] / 0.85
    # The middle of the headrope needs a node, which only every other row has.
    square = sum(p.length for p in plan.wing('upper') if p.pieces == 1)
    assert mouth == pytest.approx(ahead - square, abs=1.6 * mesh.edge_rest)


def test_what_hangs_on_ropes_weighs_what_the_file_says(tmp_path: Path) -> None:
    data = plan_data()
    hung = data.pop('hung')
    with_it, without = (
        build_model(loaded(tmp_path, data | more)) for more in ({'hung': hung}, {'hung': []})
    )
    more = with_it.lump_mass - without.lump_mass
    water = with_it.water
    weight = more - water.density * (with_it.lump_volume - without.lump_volume)
    per_side = 2 * hung[0]['weight_in_water_n']
    total = per_side + hung[1]['weight_in_water_n'] - hung[2]['buoyancy_n']
    assert weight.sum() * water.gravity == pytest.approx(total, rel=1e-9)
    port, starboard = (np.concatenate(side) for side in with_it.layout.bridles_by_side)
    assert more[port].sum() == pytest.approx(more[starboard].sum())
    # The last 6 % of a bridle lie between its last node and the wing tip.
    lower = with_it.layout.bridles[1]
    assert more[lower[:-1]].sum() == 0.0
    assert more[with_it.layout.bridle_ends[1]] > 0.6 * per_side / 2 / water.gravity


def test_a_chain_weighs_so_much_per_metre_of_its_rope(tmp_path: Path) -> None:
    data = plan_data()
    chain = {'name': 'chain', 'rope': 'footrope', 'weight_in_water_n_m': 20.0}
    data['hung'] = [chain | {'from_share': 0.25, 'to_share': 0.75}]
    gear = loaded(tmp_path, data)
    model = build_model(gear)
    data['hung'] = []
    more = model.lump_mass - build_model(loaded(tmp_path, data)).lump_mass
    weight = 20.0 * 0.5 * plan_of(gear).rope_length('footrope')
    steel = 7800.0 / (7800.0 - model.water.density)
    assert more.sum() * model.water.gravity == pytest.approx(weight * steel, rel=1e-9)
    foot = model.layout.footrope
    assert more[foot].sum() == pytest.approx(more.sum())
    assert more[foot[0]] == 0.0


def test_three_bridles_of_different_length_end_where_the_file_says(tmp_path: Path) -> None:
    data = plan_data()
    data['bridles'] = [
        {'name': 'upper', 'at_board': 'upper', 'at_net': 'upper', 'length_m': 98.0},
        {'name': 'middle', 'at_board': 'lower', 'at_net': 'side', 'segments': 3},
        {'name': 'lower', 'at_board': 'lower', 'at_net': 'lower', 'diameter_m': 0.02},
    ]
    gear = loaded(tmp_path, data)
    model = build_model(gear)
    assert [len(line) for line in model.layout.bridles] == [5, 2, 5, 5, 2, 5]
    assert len(gear.refined(bridle=2).bridles) == 3
    lines = {name: (points, bars) for name, points, bars in model.layout.lines}
    points, bars = lines['starboard_middle_bridle']
    side = model.layout.net[model.net_mesh.wing_ends[1]]
    assert points[0] == model.nodes + 5
    assert points[-1] == side[len(side) // 2]
    assert model.rest[bars].sum() == pytest.approx(gear.bridle.length_m)
    assert model.rest[lines['port_upper_bridle'][1]].sum() == pytest.approx(98.0)
    assert model.bars.normal_area[lines['port_lower_bridle'][1]].max() == 0.02


def exposed(piece: PieceRecord, net: NettingRecord) -> Exposure:
    """Exposure of the netting of a piece without taper."""
    return exposure(section_of(piece, net, piece.length, 1.0, 1.0), net)


def test_knotless_netting_has_no_knots_and_dense_netting_less_drag(tmp_path: Path) -> None:
    data = plan_data()
    for row in data['netting']['plan']['pieces']:
        row['knots'] = 'knotless'
    gear = loaded(tmp_path, data)
    assert build_model(gear).net_mesh.knot_area.max() == 0.0
    pieces = plan_of(gear).pieces
    left = {p.mesh_mm: exposed(p, gear.netting).friction for p in pieces}
    assert all(0.3 < part < 1.0 for part in left.values())
    assert left[800] > 0.95
    assert left[800] > left[80] > left[22]


def test_the_kite_hangs_on_a_planned_headrope(tmp_path: Path) -> None:
    data = plan_data()
    data['kite'] = {
        'area_m2': 2.0,
        'mass_kg': 10.0,
        'volume_m3': 0.01,
        'setting_deg': 5.0,
        'chord_m': 4.0,
        'normal_slope': 5.2,
        'normal_limit': 1.58,
        'drag_base': 0.1,
    }
    model = build_model(loaded(tmp_path, data))
    head = model.layout.headrope
    assert model.layout.kite.nodes[0] == head[len(head) // 2]


def halved(row: dict[str, Any], panel: str) -> dict[str, Any]:
    """Half of a side panel's piece, under the name of one of its two panels."""
    counts = {key: 0.5 * row[key] for key in ('front_meshes', 'back_meshes')}
    return {key: value for key, value in row.items() if key != 'cut'} | counts | {'panel': panel}


def test_sides_that_are_cut_in_two_along_their_middle_are_the_same_net(tmp_path: Path) -> None:
    data = plan_data()
    whole = build_model(loaded(tmp_path, data))
    rows = data['netting']['plan']['pieces']
    data['netting']['plan']['pieces'] = [
        half
        for row in rows
        for half in (
            [halved(row, 'side_upper'), halved(row, 'side_lower')]
            if (row['part'], row['panel']) == ('body', 'side')
            else [row]
        )
    ]
    six = build_model(loaded(tmp_path, data))
    assert sorted(plan_of(six.gear).panels) == ['lower', 'side_lower', 'side_upper', 'upper']
    np.testing.assert_allclose(six.rest, whole.rest, rtol=1e-12)
    for mine, other in zip(six.bars.columns, whole.bars.columns, strict=True):
        np.testing.assert_allclose(mine, other, rtol=1e-9, atol=1e-15)


def test_the_twine_of_either_side_panel_lies_above_and_below(tmp_path: Path) -> None:
    data = plan_data()
    thick = [dict(row) for row in SIX_PANELS]
    data['netting']['plan']['pieces'] = thick
    for rope in ('headrope', 'footrope', 'side_rope'):
        data.get(rope, {}).pop('length_m', None)
    model = build_model(loaded(tmp_path, data))
    cloth = PlannedCloth(
        model.gear.netting, PlannedMouth(plan_of(model.gear), model.gear.netting.around)
    )
    upper, middle, lower = cloth.bounds(10.0)
    # 110 + 40 + 20 + 110 + 20 + 40 meshes around the mouth, narrowing by as many parts each.
    assert 0.0 < upper < middle < lower < 0.5
    front = cloth.bounds(1e-9)
    np.testing.assert_allclose(front, np.array([55.0, 95.0, 115.0]) / 340.0, rtol=1e-6)
    above, below = (cloth.bodies[panel].sections[0] for panel in ('side_upper', 'side_lower'))
    assert below.twine_diameter_m == pytest.approx(np.sqrt(2.0) * above.twine_diameter_m)


@pytest.mark.parametrize(
    ('cut', 'slope'), [('AB', 1.0), ('AN', 0.0), ('1N2B', 0.5), ('1N4B', 2 / 3), ('1T2B', 2.0)]
)
def test_cutting_rates(cut: str, slope: float) -> None:
    assert cut_slope(cut) == pytest.approx(slope)


def test_a_cutting_rate_stands_for_a_missing_count(tmp_path: Path) -> None:
    data = plan_data()
    pieces = data['netting']['plan']['pieces']
    body = next(row for row in pieces if row.get('section') == '400 mm')
    del body['back_meshes']
    body['cut'] = '1N2B'
    wing = pieces[0]
    del wing['front_meshes']
    read = plan_of(loaded(tmp_path, data)).pieces
    assert next(p for p in read if p.section == '400 mm').back_meshes == pytest.approx(152 - 25)
    assert read[0].front_meshes == pytest.approx(40 - 25.5)


@pytest.mark.parametrize(
    ('change', 'part'),
    [
        (lambda p: p[0].update(cut='2Q'), "cut: found '2Q'"),
        (lambda p: p[0].pop('rtex'), 'neither rtex nor twine_diameter_mm'),
        (lambda p: p[0].update(panel='all'), 'panel: found all'),
        (lambda p: p.pop(0), 'no wing of the upper'),
        (
            lambda p: p[5].update(long_meshes=40),
            "section '800 mm' are 20 to 32 m",
        ),
        (lambda p: p[-1].update(front_meshes=0), 'has 0 front_meshes'),
        (lambda p: p[0].update(material='cotton'), "found 'cotton', expected 'PA'"),
        (lambda p: p[0].update(mesh_mm=1.0), 'mesh_mm: found 1.0'),
        (
            lambda p: p[0].update(orientation='ropes'),
            'orientation: found ropes',
        ),
        (
            lambda p: p[5].update(orientation='ropes', back_meshes=p[5]['front_meshes']),
            "section '800 mm' has ropes",
        ),
        (
            lambda p: p[13].update(orientation='ropes', back_meshes=p[13]['front_meshes']),
            "section '120 mm' has ropes",
        ),
    ],
)
def test_a_plan_that_cannot_be_is_refused(tmp_path: Path, change: Any, part: str) -> None:
    data = plan_data()
    change(data['netting']['plan']['pieces'])
    with pytest.raises(GearError) as caught:
        loaded(tmp_path, data)
    assert part in str(caught.value)


@pytest.mark.parametrize(
    ('changes', 'part'),
    [
        ({'netting': {'wing_end_m': 3.0}}, 'netting.wing_end_m: found'),
        ({'hung': [{'name': 'x', 'rope': 'kite', 'buoyancy_n': 1.0}]}, 'hung[0].rope: found kite'),
        (
            {'hung': [{'name': 'x', 'rope': 'headrope'}]},
            'hung[0]: found 0',
        ),
        (
            {'bridles': [{'name': 'upper', 'at_board': 'upper', 'at_net': 'upper'}]},
            'bridles: found none',
        ),
    ],
)
def test_a_rigging_that_cannot_be_is_refused(
    tmp_path: Path, changes: dict[str, Any], part: str
) -> None:
    data = plan_data()
    for key, value in changes.items():
        data[key] = data[key] | value if isinstance(value, dict) else value
    with pytest.raises(GearError) as caught:
        loaded(tmp_path, data)
    assert part in str(caught.value)


def test_a_rope_that_is_too_short_for_its_bosom_is_refused(tmp_path: Path) -> None:
    data = plan_data()
    data['headrope']['length_m'] = 15.0
    with pytest.raises(GearError, match=r'headrope\.length_m: found 15'):
        build_model(loaded(tmp_path, data))


@pytest.mark.parametrize('around', AROUND)
def test_netting_along_the_wings_is_as_long_as_planned(gear: GearRecord, around: int) -> None:
    """From each wing tip to the mouth, along the bars, whatever the rows of the mouth."""
    mesh = cut_to(gear, around).net_mesh
    assert mesh.frame is not None
    plan = plan_of(gear)
    for rim, panel in zip(mesh.frame, ('upper', 'lower'), strict=False):
        if any(piece.pieces == 1 for piece in plan.wing(panel)):
            continue
        edge = sum(m for k, m in zip(rim.kinds, rim.netting, strict=True) if k == 'edge')
        assert edge == pytest.approx(2 * plan.wing_length(panel), rel=1e-9)


def codend_drag(gear: GearRecord) -> float:
    """C_D S (m²) of the codend's nodes, which only the codend has."""
    model = cut_to(gear, 24)
    last = model.layout.net[-gear.netting.codend_segments :]
    return float(model.lump_drag_area[last].sum())


def turned(gear: GearRecord, part: str, **changes: Any) -> GearRecord:
    plan = plan_of(gear)
    pieces = tuple(
        piece.model_copy(update=changes) if piece.part == part else piece for piece in plan.pieces
    )
    netting = gear.netting.model_copy(update={'plan': plan.model_copy(update={'pieces': pieces})})
    return gear.model_copy(update={'netting': netting})


def test_turned_meshes_are_kept_open_by_their_knots() -> None:
    gear = load_gear('krill_800')
    knotted = turned(gear, 'codend', knots='knotted')
    across = turned(gear, 'codend', knots='knotted', orientation='T90')
    piece = plan_of(across).pieces[-1]
    sine = np.sin(mesh_angle(piece, gear.netting))
    knots = 2 * 2.5 * piece.twine.diameter / piece.mesh
    start = np.sin(np.radians(gear.netting.codend_mesh_angle_deg))
    assert sine == pytest.approx(start + knots * (1 - start))
    assert codend_drag(across) > 1.2 * codend_drag(knotted)
    # Nothing keeps meshes without knots open.
    assert codend_drag(turned(gear, 'codend', orientation='T90')) == pytest.approx(
        codend_drag(gear), rel=1e-12
    )


def test_half_of_the_bars_of_square_meshes_lie_across() -> None:
    gear = load_gear('krill_800')
    plan = plan_of(gear)
    last = plan.pieces[-1]
    # As long and wide as the diamonds are stretched: twice the counts, in bars.
    counts = {key: 2 * getattr(last, key) for key in ('front_meshes', 'back_meshes', 'long_meshes')}
    square = last.model_copy(update={'orientation': 'square', **counts})
    assert square.length == last.length
    assert square.twine_length == pytest.approx(2 * last.twine_length)
    gear, changed = (
        gear.model_copy(
            update={
                'netting': gear.netting.model_copy(
                    update={'plan': plan.model_copy(update={'pieces': some, 'shielded': False})}
                )
            }
        )
        for some in (plan.pieces, (*plan.pieces[:-1], square))
    )
    net = gear.netting
    angle = np.radians(net.codend_mesh_angle_deg)

    def drag(across: float, along: float) -> float:
        return net.normal_drag * across + net.friction * np.pi * along

    before = drag(np.sin(angle) ** 3, np.cos(angle) ** 3) * last.twine_area
    after = drag(0.5, 0.5) * square.twine_area
    assert codend_drag(changed) - codend_drag(gear) == pytest.approx(after - before, rel=0.05)


def squared(data: dict[str, Any], section: str) -> dict[str, Any]:
    """A plan with a section of square meshes as long as it was, and half as wide as stretched."""
    row = next(row for row in data['netting']['plan']['pieces'] if row.get('section') == section)
    row['orientation'] = 'square'
    row['long_meshes'] *= 2  # counted in bars
    return data


def test_square_meshes_ahead_of_the_codend_are_a_part_of_its_line(tmp_path: Path) -> None:
    gear = loaded(tmp_path, squared(plan_data(), '22 mm aft'))
    plan, model, before = plan_of(gear), build_model(gear), build_model(load_gear('krill_800'))
    area = sum(bar.area * bar.rest for bar in model.net_mesh.bars)
    assert area == pytest.approx(sum(p.twine_area for p in plan.pieces), rel=0.02)
    steps = [bar.rest for bar in model.net_mesh.bars[-gear.netting.codend_segments + 1 :]]
    long = gear.netting.codend_segments * steps[0]
    tail = sum(p.length for p in plan.pieces if p.part == 'codend')
    square = next(p for p in plan.pieces if p.orientation == 'square')
    assert tail + square.length <= long <= tail + square.length + 1.0
    assert len(model.net_mesh.positions) < len(before.net_mesh.positions)
    # Its bars across have more drag than slanting ones.
    line, was = (m.lump_drag_area[m.layout.net].sum() for m in (model, before))
    assert line > was


@pytest.mark.parametrize(
    ('section', 'message'),
    [
        ('800 mm', r'pieces\[4\]\.orientation: found square'),
        ('120 mm', None),
    ],
)
def test_square_meshes_are_refused_in_panels_alone(
    tmp_path: Path, section: str, message: str | None
) -> None:
    data = squared(plan_data(), section)
    if message is None:
        assert build_model(loaded(tmp_path, data)).nodes > 100
        return
    with pytest.raises(GearError, match=message):
        loaded(tmp_path, data)


def test_ropes_run_straight_from_the_mouth_to_the_netting(tmp_path: Path) -> None:
    data = plan_data()
    data['netting']['plan']['pieces'] = ROPE_FRONT
    mesh = cut_to(loaded(tmp_path, data), 24).net_mesh
    angle = np.arctan2(mesh.positions[:, 1], mesh.positions[:, 2])
    straight = [bar for bar in mesh.bars if abs(angle[bar.start] - angle[bar.end]) < 1e-12]
    straight = [bar for bar in straight if bar.group == 'netting']
    # 340 ropes of 12 m and 12 mm, in 24 lines.
    assert sum(bar.rest for bar in straight) == pytest.approx(24 * 12.0)
    assert sum(bar.area * bar.rest for bar in straight) == pytest.approx(340 * 12.0 * 0.012)
    assert {(bar.normal, bar.sliding) for bar in straight} == {(1.0, 1.0)}
    first = {bar.start for bar in straight} - {bar.end for bar in straight}
    assert len(first) == 24
    assert mesh.headrope[len(mesh.headrope) // 2] in first


def test_a_gear_with_a_front_of_ropes_is_towed(tmp_path: Path) -> None:
    data = plan_data()
    data['netting']['around'] = 24
    rows = data['netting']['plan']['pieces']
    for row in rows:
        if row.get('section') == '800 mm':
            row.update(orientation='ropes', back_meshes=row['front_meshes'], twine_diameter_mm=10.0)
            del row['rtex']
    gear = loaded(tmp_path, data)
    assert [f for f in findings(gear) if 'pieces' in f.key] == []
    model = build_model(gear)
    found = steady_state(model, 400.0, 1.3)
    assert 10.0 < found.observables.vertical_opening < 30.0
    assert 20.0 < found.observables.horizontal_opening < 60.0
