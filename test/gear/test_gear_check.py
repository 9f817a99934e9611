"""`trawl gear`: a file is checked, drawn and made from a table before anything is solved."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from click.testing import CliRunner

from trawl_ros.api.gear_check import check_gear, drag_of_model, draw_gear
from trawl_ros.cli.main import trawl
from trawl_ros.core.errors import GearError
from trawl_ros.core.resources import share_path
from trawl_ros.gear.drag_bands import BANDS
from trawl_ros.gear.findings import findings
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.plan_table import plan_text, read_plan

GEARS = sorted(path.stem for path in share_path('config', 'gear').iterdir())


def changed(folder: Path, name: str, change: Any) -> Path:
    data = yaml.safe_load(share_path('config', 'gear', f'{name}.yaml').read_text())
    change(data)
    path = folder / 'own.yaml'
    path.write_text(yaml.safe_dump(data))
    return path


def test_nothing_looks_wrong_in_the_default_gear() -> None:
    assert findings(load_gear('kaifuha')) == ()


@pytest.mark.parametrize('name', GEARS)
def test_weights_are_those_of_all_nodes_and_bars(name: str) -> None:
    check = check_gear(name)
    model, water = check.model, check.model.water
    bars = model.bars
    heavy = water.gravity * (bars.mass - water.density * bars.volume) * model.rest
    lumps = water.gravity * (model.lump_mass - water.density * model.lump_volume)
    whole = heavy[model.warp_side < 0].sum() + lumps.sum()
    own = {'boards', 'plates', 'kite'}
    told = sum(weight for part, weight in check.weights.items() if part not in own)
    assert told == pytest.approx(whole, rel=1e-9)


def test_figures_of_the_plan_add_up() -> None:
    check = check_gear('krill_800')
    plan = check.gear.netting.plan
    assert plan is not None
    assert check.twine_area == pytest.approx(sum(p.twine_area for p in plan.pieces), rel=5e-3)
    # The net's drag lies between half of the least and the most of what others found.
    for knots, bands in check.drag.items():
        assert 0.5 * min(bands.values()) < drag_of_model(check.model, knots) < max(bands.values())
        assert set(bands) == set(BANDS)


def test_what_is_not_given_is_told() -> None:
    derived = check_gear('krill_800').derived
    assert derived['twine of PA R3370'] == '2.21 mm'
    assert derived['headrope.length_m'] == '58.85'
    assert derived['board.added_mass_kg'].startswith('[0, 9')
    assert 'xx_kg_m2 2080' in derived['board.inertia']
    assert 'board.mass_kg' not in derived


FAULTS = [
    ('kaifuha', lambda d: d['headrope'].update(length_m=120.0), 'headrope.length_m', '120 m'),
    ('kaifuha', lambda d: d['headrope'].update(length_m=150.0), 'headrope.length_m', 'ratio'),
    (
        'kaifuha',
        lambda d: d['netting']['codend'][0].update(front_circumference_m=900.0),
        'netting.codend[0]',
        '900 m',
    ),
    (
        'kaifuha',
        lambda d: d['netting']['codend'][1].update(twine_diameter_m=0.03),
        'netting.codend[1]',
        '30 mm',
    ),
    ('kaifuha', lambda d: d['warp'].update(diameter_m=0.016), 'warp.stiffness_n', '4.1e+07 N'),
    ('kaifuha', lambda d: d['board'].update(area_m2=20.0), 'board.area_m2', '20 m²'),
    ('kaifuha', lambda d: d['board'].update(volume_m3=3.0), 'board.volume_m3', '867 kg/m³'),
    (
        'kaifuha',
        lambda d: d['board']['inertia'].update(zz_kg_m2=9000.0),
        'board.inertia.zz_kg_m2',
        '9000',
    ),
    (
        'kaifuha',
        lambda d: d['board']['fastening'].update(warp_m=[-1.0, 0.0, 0.0]),
        'board.fastening.warp_m',
        'bridle',
    ),
    ('krill_800', lambda d: d['headrope'].update(length_m=40.0), 'headrope.length_m', '0.50'),
    (
        'krill_800',
        lambda d: d['netting']['plan']['pieces'][8].update(front_meshes=200),
        'netting.plan.pieces[8]',
        '80 m',
    ),
    (
        'krill_800',
        lambda d: d['netting']['plan']['pieces'][4].update(cut='AB'),
        'netting.plan.pieces[4]',
        '110 to 76',
    ),
    (
        'krill_800',
        lambda d: d['netting']['plan']['pieces'][4].update(twine_diameter_mm=1.0),
        'netting.plan.pieces[4]',
        'Rtex',
    ),
    (
        'krill_800',
        lambda d: d['netting']['plan']['pieces'][1].update(long_meshes=20),
        'netting.plan (side_upper wing)',
        '16 m',
    ),
    (
        'krill_800',
        lambda d: d.update(
            bridles=[
                {'name': 'upper', 'at_board': 'upper', 'at_net': 'upper', 'length_m': 60.0},
                {'name': 'lower', 'at_board': 'lower', 'at_net': 'lower'},
            ]
        ),
        'bridles',
        'upper 60 m, lower 100 m',
    ),
    (
        'kaifuha',
        lambda d: d['warp'].update(weight_in_water_n_m=2.8),
        'warp.weight_in_water_n_m',
        '27.5 N/m',
    ),
    (
        'krill_800',
        lambda d: d['bridle'].update(weight_in_water_n_m=0.8),
        'bridle.weight_in_water_n_m',
        '0.8 N/m',
    ),
    (
        'kaifuha',
        lambda d: d['warp'].update(weight_in_water_n_m=-5.0),
        'warp.weight_in_water_n_m',
        '-5 N/m',
    ),
    (
        'pair_368',
        lambda d: d['warp'].update(weight_in_water_n_m=-5.0),
        'warp.weight_in_water_n_m',
        '-5 N/m',
    ),
    (
        'kaifuha',
        lambda d: d['bridle'].update(length_m=2000.0),
        'bridles (upper)',
        '2000 m',
    ),
]


@pytest.mark.parametrize(('name', 'change', 'key', 'number'), FAULTS)
def test_what_looks_wrong_is_said_with_key_found_and_expected(
    tmp_path: Path, name: str, change: Any, key: str, number: str
) -> None:
    told = findings(load_gear(changed(tmp_path, name, change)))
    assert any(one.key == key and number in one.sentence for one in told), told


def test_the_command_prints_draws_and_ends_with_a_code_of_its_own(tmp_path: Path) -> None:
    done = CliRunner().invoke(trawl, ['gear', 'check', 'krill_800', '--out', str(tmp_path / 'out')])
    assert done.exit_code == 0, done.output
    for part in ('361.5 m² of twine', 'front weight', 'Reid 1977', 'nothing looks wrong'):
        assert part in done.output
    pictures = sorted(path.name for path in (tmp_path / 'out').iterdir())
    assert pictures == ['gear.png', 'net_plan.png']
    path = changed(tmp_path, 'kaifuha', lambda d: d['headrope'].update(length_m=120.0))
    done = CliRunner().invoke(trawl, ['gear', 'check', str(path)])
    assert done.exit_code == 3
    assert 'looks wrong: headrope.length_m' in done.output


def test_pictures_show_every_piece_and_every_rope(tmp_path: Path) -> None:
    from trawl_ros.plots.net_plan import net_plan_figure
    from trawl_ros.plots.rigged_gear import rigged_gear_figure

    gear = load_gear('krill_800')
    assert gear.netting.plan is not None
    figure = net_plan_figure(gear.name, gear.netting.plan)
    upper, side, lower = figure.axes
    sections = len(gear.netting.plan.sections('body')) + len(gear.netting.plan.sections('codend'))
    for axes in (upper, side, lower):
        assert len(axes.patches) == sections + 2
    area = check_gear('kaifuha')
    views = rigged_gear_figure(area.model)
    for axes in views.axes:
        pieces = sum(len(lines.get_segments()) for lines in axes.collections)
        # Warps are left out, boards have four edges each.
        assert pieces == len(area.model.ends) - 2 * area.model.warp_segments + 8
    (drawn,) = draw_gear(area, tmp_path)
    assert drawn.stat().st_size > 20_000


def table_of(folder: Path, text: str) -> Path:
    path = folder / 'plan.csv'
    path.write_text(text)
    return path


GOOD = """part;panel;section;mesh_mm;front_meshes;back_meshes;long_meshes;rtex;material;cut
# from the front to the back
wing;upper;;800;16;40;25.5;3370;PA;
wing;lower;;800;16;40;25.5;3370;PA;

body;upper;front;800;110;;25;3370;PA;1N4B
body;lower;front;800;110;76;25;3370;PA;
codend;all;end;40;3000;2000;100;2000;PE;
"""


@pytest.mark.parametrize('mark', [';', ','])
def test_a_table_becomes_a_plan_that_reads_back_the_same(tmp_path: Path, mark: str) -> None:
    plan = read_plan(table_of(tmp_path, GOOD.replace(';', mark)))
    assert len(plan.pieces) == 5
    assert plan.pieces[2].back_meshes == pytest.approx(110 - 2 * 25 * 2 / 3)
    done = CliRunner().invoke(trawl, ['gear', 'import', str(tmp_path / 'plan.csv')])
    assert done.exit_code == 0
    assert done.output == plan_text(plan)
    read = yaml.safe_load(done.output)['plan']
    path = changed(tmp_path, 'krill_800', lambda d: d['netting'].update(plan=read))
    again = load_gear(path).netting.plan
    assert again is not None
    for ours, theirs in zip(again.pieces, plan.pieces, strict=True):
        assert ours == theirs


@pytest.mark.parametrize(
    ('text', 'part'),
    [
        ('', 'plan.csv: '),
        ('part,colour\n', "column 'colour'"),
        ('part,part\n', "column 'part'"),
        (GOOD.replace('wing;upper;;800', 'wing;upper;;thick'), "line 3: mesh_mm: found 'thick'"),
        (GOOD.replace(';PA;\n', ';PA\n', 1), 'line 3: found 9 cells'),
        (GOOD.replace('wing;upper', 'flap;upper'), "line 3: part: found 'flap'"),
        (GOOD.replace('codend;all', 'body;all'), 'found no codend'),
        (GOOD.replace('body;lower', 'body;"lower'), 'found no table'),
        (GOOD.replace('body;lower', 'body;lo\x1b[2Jwer'), 'a control character'),
    ],
)
def test_a_table_that_is_no_plan_is_refused_with_its_line(
    tmp_path: Path, text: str, part: str
) -> None:
    with pytest.raises(GearError) as caught:
        read_plan(table_of(tmp_path, text))
    assert part in str(caught.value)


def test_a_huge_table_and_a_device_are_refused_at_once(tmp_path: Path) -> None:
    huge = tmp_path / 'huge.csv'
    with huge.open('wb') as file:
        file.truncate(10**10)
    for path in (huge, Path('/dev/zero'), tmp_path):
        with pytest.raises(GearError, match='expected a'):
            read_plan(path)


def test_doors_are_listed_with_their_sources() -> None:
    done = CliRunner().invoke(trawl, ['gear', 'doors'])
    assert done.exit_code == 0
    assert 'flat_wooden' in done.output
    assert '0.93 at 32°' in done.output


def test_bands_grow_with_speed_and_area() -> None:
    for band in BANDS.values():
        drag = np.array([band(300.0, knots) for knots in (1.0, 2.0, 3.0, 4.0)])
        assert np.all(np.diff(drag) > 0)
        assert band(600.0, 3.0) == pytest.approx(2 * band(300.0, 3.0))


def test_catch_and_kites_are_told(tmp_path: Path) -> None:
    def change(data: dict[str, Any]) -> None:
        data['catch'] = {'mass_kg': 5000.0}
        data['hung'].append({'name': 'side kites', 'rope': 'side_rope', 'lift_area_m2': 1.0})

    result = CliRunner().invoke(
        trawl, ['gear', 'check', str(changed(tmp_path, 'krill_800', change))]
    )
    assert result.exit_code == 0, result.output
    assert 'catch: 6.25 m³ in 2.33 m' in result.output
    # ½ ρ (2 knots)² of 1 m² on either side.
    assert 'side kites: lift of 1085 N' in result.output


@pytest.mark.parametrize(
    ('name', 'old', 'new', 'key'),
    [
        ('kaifuha', 'weight_in_water_n_m: 28.0', 'weight_in_water_n_m: 46.0', 'warp.weight_in_w'),
        ('flume_83_112', 'length_m: 34.1', 'length_m: 60.0', 'headrope.length_m'),
        ('kaifuha', 'normal_drag: 1.1 ', 'normal_drag: 0.1 ', 'netting'),
    ],
)
def test_values_that_disagree_are_found(
    name: str, old: str, new: str, key: str, tmp_path: Path
) -> None:
    text = share_path('config', 'gear', f'{name}.yaml').read_text()
    assert old in text
    path = tmp_path / 'wrong.yaml'
    path.write_text(text.replace(old, new))
    assert any(finding.key.startswith(key) for finding in check_gear(path).findings)
