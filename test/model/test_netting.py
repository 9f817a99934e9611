"""Grouping keeps what the real netting has: twine, knots, weight and stiffness."""

import numpy as np
import pytest

from trawl_ros.core.errors import GearError
from trawl_ros.gear.netting import NettingRecord, SectionRecord
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.model.net.netting import NetMesh, build_net
from trawl_ros.model.net.rows import Profile, rows_of

AROUND = (12, 24, 36)


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


@pytest.mark.parametrize('around', AROUND)
@pytest.mark.parametrize('name', ['area', 'volume', 'mass'])
def test_twine_is_kept(gear: GearRecord, around: int, name: str) -> None:
    mesh = build_net(with_around(gear, around), CHORD)
    bars = [*body_bars(mesh), *(bar for bar in mesh.bars if bar.group == 'codend')]
    sections = (*gear.netting.body, *gear.netting.codend)
    found = sum(getattr(bar, name) * bar.rest for bar in bars)
    assert found == pytest.approx(total(sections, name), rel=3e-3)


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
        # The last piece of a row belongs to the codend, the wings come on top.
        assert 0.9 * body < lumps.sum() < body * (1 + wings) + scale * first[name]


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
    rows: dict[float, float] = {}
    for bar in body:
        rows[float(mesh.positions[bar.start][0])] = bar.rest
    length = sum(section.length_m for section in gear.netting.body)
    # What is shorter than a row belongs to the codend's line.
    assert length - 2 * min(rows.values()) < sum(rows.values()) <= length


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
    rows = rows_of(profile, around, (800.0, 400.0))
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
        # Numerical meshes are as wide as the real ones, so their rows shorten with them.
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
        ({'length_m': 600_000.0}, 'have more than 30000 nodes, expected fewer meshes around'),
        ({'length_m': 0.001}, 'are 0 rows of the mesh, expected at least 3'),
        (
            {'front_circumference_m': 1e-300, 'back_circumference_m': 1e-300},
            'have more than 30000 nodes',
        ),
    ],
)
def test_a_net_is_bounded_before_it_is_built(gear, changes, part):
    body = tuple(section.model_copy(update=changes) for section in gear.netting.body)
    asked = gear.model_copy(update={'netting': gear.netting.model_copy(update={'body': body})})
    with pytest.raises(GearError, match=part):
        build_model(asked)
