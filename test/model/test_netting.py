"""Grouping keeps what the real netting has: twine, knots, weight and stiffness."""

import numpy as np
import pytest

from trawl_ros.core.errors import GearError
from trawl_ros.gear.netting import NettingRecord, SectionRecord
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.model.net.netting import NetMesh, build_net
from trawl_ros.model.net.rows import Profile, rows_of
from trawl_ros.solver.equilibrium import steady_state

AROUND = (12, 24, 36)

MANY = (24, 36, 48, 60, 72, 96)

CHORD = 24.0


def with_around(
    gear: GearRecord, around: int, halved_at: tuple[float, ...] = (800.0, 400.0)
) -> NettingRecord:
    return gear.netting.model_copy(
        update={'around': around, 'halved_at_circumference_m': halved_at}
    )


def real_netting(section: SectionRecord) -> dict[str, float]:
    """Twine of a conical section counted mesh by mesh: four bars and two knots per mesh."""
    around = 0.5 * (section.front_circumference_m + section.back_circumference_m) / section.mesh_m
    meshes = around * section.length_m / section.mesh_m
    twine = meshes * 4 * section.mesh_m / 2
    d = section.twine_diameter_m
    return {
        'area': twine * d,
        'volume': twine * np.pi / 4 * d**2,
        'mass': twine * np.pi / 4 * d**2 * section.twine_density_kg_m3,
        'knot_area': 2 * meshes * np.pi / 4 * d**2,
        'knot_volume': 2 * meshes * np.pi / 6 * d**3,
    }


def total(sections: tuple[SectionRecord, ...], name: str) -> float:
    return sum(real_netting(section)[name] for section in sections)


def body_bars(mesh: NetMesh) -> list:
    """Bars behind the mouth: what lies ahead of it are the wings, cut from the first row."""
    first = mesh.positions[mesh.headrope[len(mesh.headrope) // 2]][0]
    return [
        bar
        for bar in mesh.bars
        if bar.group == 'netting' and mesh.positions[bar.start][0] <= first + 1e-9
    ]


@pytest.mark.parametrize('around', MANY)
@pytest.mark.parametrize('name', ['area', 'volume', 'mass'])
def test_twine_is_kept(gear: GearRecord, around: int, name: str) -> None:
    mesh = build_net(with_around(gear, around), CHORD)
    found = {
        'netting': sum(getattr(bar, name) * bar.rest for bar in body_bars(mesh)),
        'codend': sum(getattr(b, name) * b.rest for b in mesh.bars if b.group == 'codend'),
    }
    assert found['netting'] == pytest.approx(total(gear.netting.body, name), rel=1e-9)
    assert found['codend'] == pytest.approx(total(gear.netting.codend, name), rel=1e-9)


@pytest.mark.parametrize('around', MANY)
@pytest.mark.parametrize('halved_at', [(), (800.0, 400.0), (900.0, 600.0, 300.0)])
def test_the_netting_is_as_long_as_the_sections_however_it_is_cut(
    gear: GearRecord, around: int, halved_at: tuple[float, ...]
) -> None:
    mesh = build_net(with_around(gear, around, halved_at), CHORD)
    rests = {float(mesh.positions[bar.start][0]): bar.rest for bar in body_bars(mesh)}
    body, codend = gear.netting.body, gear.netting.codend
    assert sum(rests.values()) == pytest.approx(sum(s.length_m for s in body), rel=1e-9)
    line = {bar.end: bar.rest for bar in mesh.bars if bar.group == 'codend'}
    assert sum(line.values()) == pytest.approx(sum(s.length_m for s in codend), rel=1e-9)
    # So the drag of the line is that of the codend alone.
    coarse = build_net(with_around(gear, 12, ()), CHORD)
    assert mesh.line_drag_area.sum() == pytest.approx(coarse.line_drag_area.sum(), rel=1e-9)


@pytest.mark.parametrize('around', MANY)
@pytest.mark.parametrize('halved_at', [(800.0, 400.0), (1000.0, 500.0), (1200.0, 900.0)])
def test_lines_of_bars_from_the_corners_of_the_wings_go_on_to_the_codend(
    gear: GearRecord, around: int, halved_at: tuple[float, ...]
) -> None:
    mesh = build_net(with_around(gear, around, halved_at), CHORD)
    behind: dict[int, list[int]] = {}
    for bar in mesh.bars:
        if bar.group == 'netting':
            behind.setdefault(bar.start, []).append(bar.end)

    def angle(node: int) -> float:
        _, y, z = mesh.positions[node]
        return float(np.arctan2(y, z / 0.6))

    # With a quarter of 9 meshes and the like top and bottom cannot both be met at a second join.
    rims = (mesh.headrope, mesh.footrope) if around % 24 == 0 else (mesh.headrope,)
    corners = [rim[count] for rim in rims for count in (around // 12, -1 - around // 12)]
    for corner in corners:
        for sense in (-1.0, 1.0):
            node, rows = corner, 0
            while node in behind:
                turns = [np.angle(np.exp(1j * (angle(end) - angle(node)))) for end in behind[node]]
                best = int(np.argmax(sense * np.array(turns)))
                assert sense * turns[best] > 0.0, f'the line ends behind row {rows}'
                node, rows = behind[node][best], rows + 1
            assert rows > around // 4


def test_joining_meshes_hardly_changes_the_tow(gear: GearRecord) -> None:
    joined, whole = (
        steady_state(build_model(gear.model_copy(update={'netting': net})), 500.0, 2.1).observables
        for net in (with_around(gear, 36), with_around(gear, 36, ()))
    )
    assert joined.port_tension == pytest.approx(whole.port_tension, rel=1e-3)
    assert joined.door_spread == pytest.approx(whole.door_spread, rel=1e-3)
    assert joined.vertical_opening == pytest.approx(whole.vertical_opening, rel=2e-3)
    for name in ('port_attack', 'port_inclination', 'port_roll'):
        assert getattr(joined, name) == pytest.approx(getattr(whole, name), abs=np.radians(0.3))


@pytest.mark.parametrize('around', AROUND)
def test_wings_have_the_twine_of_the_netting_they_are_cut_from(
    gear: GearRecord, around: int
) -> None:
    mesh = build_net(with_around(gear, around), CHORD)
    body = {id(bar) for bar in body_bars(mesh)}
    wings = [bar for bar in mesh.bars if bar.group == 'netting' and id(bar) not in body]
    front = gear.netting.body[0]
    # A twelfth of the mouth at the base and half of that at the tip, on either side.
    width, height = front.front_circumference_m / 6, front.front_circumference_m / 24
    twine = 2 * (0.75 * width) * height / front.mesh_m * 2
    expected = 2 * 0.5 * twine * front.twine_diameter_m
    assert sum(bar.area * bar.rest for bar in wings) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize('around', AROUND)
def test_knots_are_kept(gear: GearRecord, around: int) -> None:
    record = with_around(gear, around)
    mesh = build_net(record, CHORD)
    bars = [bar for bar in mesh.bars if bar.group == 'netting']
    wings = 1.0 - len(body_bars(mesh)) / len(bars)
    first = real_netting(gear.netting.body[0])
    for lumps, name, scale in (
        (mesh.knot_area, 'knot_area', record.knot_diameters**2),
        (mesh.knot_volume, 'knot_volume', record.knot_diameters**3),
    ):
        body = scale * total(gear.netting.body, name)
        # The wings come on top.
        assert body < lumps.sum() < body * (1 + wings) + scale * first[name]


@pytest.mark.parametrize('around', AROUND)
def test_every_cross_section_is_as_stiff_as_its_twine(gear: GearRecord, around: int) -> None:
    mesh = build_net(with_around(gear, around), CHORD)
    front = gear.netting.body[0]
    mouth = mesh.positions[mesh.headrope[len(mesh.headrope) // 2]][0]
    row = [
        bar
        for bar in mesh.bars
        if bar.group == 'netting' and mesh.positions[bar.start][0] == pytest.approx(mouth)
    ]
    assert len(row) == 2 * around
    half = 0.5 * row[0].rest
    circumference = front.front_circumference_m - half / front.length_m * (
        front.front_circumference_m - front.back_circumference_m
    )
    bars = 2 * circumference / front.mesh_m
    expected = bars * np.pi / 4 * front.twine_diameter_m**2 * front.twine_modulus_pa
    assert sum(bar.stiffness for bar in row) == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize('around', AROUND)
def test_a_numerical_mesh_is_as_wide_as_the_real_ones_it_stands_for(
    gear: GearRecord, around: int
) -> None:
    # Then its bars lie at the same angle, whatever the net's opening.
    mesh = build_net(with_around(gear, around), CHORD)
    body = body_bars(mesh)
    front = body[0]
    mean = gear.netting.body[0].front_circumference_m
    assert 2 * around * front.rest == pytest.approx(mean, rel=0.12)


@pytest.mark.parametrize('around', AROUND)
def test_the_net_is_symmetric_with_a_node_at_the_middle_of_both_ropes(
    gear: GearRecord, around: int
) -> None:
    mesh = build_net(with_around(gear, around), CHORD)
    image = mesh.positions * [1.0, -1.0, 1.0]
    apart = np.linalg.norm(image[:, None] - mesh.positions[None], axis=2)
    assert apart.min(axis=1).max() < 1e-9
    twin = apart.argmin(axis=1)
    for rim in (mesh.headrope, mesh.footrope):
        np.testing.assert_array_equal(twin[rim], rim[::-1])
        assert len(rim) % 2 == 1
        assert mesh.positions[rim[len(rim) // 2]][1] == pytest.approx(0.0, abs=1e-9)
    np.testing.assert_allclose(mesh.knot_area[twin], mesh.knot_area, rtol=1e-12)
    assert mesh.kite.nodes[0] == mesh.headrope[len(mesh.headrope) // 2]


@pytest.mark.parametrize('around', [36, 48])
def test_joining_meshes_keeps_the_load_bearing_twine(gear: GearRecord, around: int) -> None:
    """Every cross-section is as stiff as its twine, ahead of a join, in it and behind it."""
    profile = Profile(gear.netting.body, gear.netting)
    rows = rows_of(profile, around, (800.0, 400.0), around // 3)
    assert [row.joins for row in rows].count(True) == 2
    assert rows[-1].around == around // 4
    for row in rows:
        middle = 0.5 * (row.front + row.back)
        section, circumference = profile.at(middle)
        bars = 2 * circumference / section.mesh_m
        expected = bars * np.pi / 4 * section.twine_diameter_m**2 * section.twine_modulus_pa
        numerical = row.around if row.joins else 2 * row.around
        per_bar = profile.per_mesh_column(row.front, row.back, row.columns)['stiffness'] / row.rest
        # A row that crosses from one section to the next has something of both.
        if profile.at(row.front)[0] is profile.at(row.back)[0]:
            assert numerical * per_bar == pytest.approx(expected, rel=2e-3)
        # Numerical meshes are as wide as the real ones, so their rows shorten with them; the last
        # one ends with the netting.
        if row is not rows[-1]:
            assert 2 * row.around * row.rest == pytest.approx(circumference, rel=0.02)


def test_the_default_gear_is_cut_as_finely_as_promised(gear: GearRecord) -> None:
    model = build_model(gear)
    assert model.warp_segments >= 20
    assert all(len(warp) == model.warp_segments - 1 for warp in model.layout.warps)
    assert model.gear.bridle.segments >= 4
    assert len(model.layout.net) >= 150


def test_ropes_have_the_length_of_the_gear_file(model: GearModel) -> None:
    gear, bars = model.gear, {}
    for name, _, numbers in model.layout.lines:
        bars.setdefault(name, []).extend(numbers.tolist())
    for name, length in (
        ('headrope', gear.headrope.length_m),
        ('footrope', gear.footrope.length_m),
        ('port_upper_bridle', gear.bridle.length_m),
        ('starboard_lower_bridle', gear.bridle.length_m),
        ('port_wing_end', gear.netting.wing_end_m),
    ):
        assert model.rest[bars[name]].sum() == pytest.approx(length, rel=1e-12), name


def test_refining_cuts_finer_and_keeps_the_gear(model: GearModel) -> None:
    fine = build_model(model.gear.refined(warp=2, bridle=3, net=2))
    assert fine.warp_segments == 2 * model.warp_segments
    assert len(fine.layout.bridles[0]) + 1 == 3 * (len(model.layout.bridles[0]) + 1)
    assert len(fine.layout.headrope) == 2 * len(model.layout.headrope) - 1
    for name in ('mass', 'volume'):
        coarse_sum, fine_sum = (
            sum(getattr(bar, name) * bar.rest for bar in m.net_mesh.bars) for m in (model, fine)
        )
        # The wings' outline follows the meshes, so their netting changes a little.
        assert fine_sum == pytest.approx(coarse_sum, rel=0.05)


@pytest.mark.parametrize(
    ('changes', 'part'),
    [
        ({'length_m': 600_000.0}, r'netting\.body: .*30000 nodes'),
        (
            {'length_m': 0.001},
            r'netting\.body: found 1 rows',
        ),
        (
            {'front_circumference_m': 1e-300, 'back_circumference_m': 1e-300},
            r'netting\.body: .*30000 nodes',
        ),
    ],
)
def test_a_net_is_bounded_before_it_is_built(gear, changes, part):
    body = tuple(section.model_copy(update=changes) for section in gear.netting.body)
    asked = gear.model_copy(update={'netting': gear.netting.model_copy(update={'body': body})})
    with pytest.raises(GearError, match=part):
        build_model(asked)
