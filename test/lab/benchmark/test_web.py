"""MoorDyn's web has the gear's own bars, and its largest stable step is found."""

import numpy as np
import pytest

from trawl_ros.lab.benchmark.gears import default_gear
from trawl_ros.lab.benchmark.web import POINT, measure, moordyn_web_factor
from trawl_ros.lab.reference_codes.moordyn_web import COUPLED, towed, web_of
from trawl_ros.model.assembly import forces
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.solver.equilibrium import Equilibrium, find_equilibrium


@pytest.fixture(scope='module')
def model() -> GearModel:
    return build_model(default_gear(quick=True))


@pytest.fixture(scope='module')
def steady(model: GearModel) -> Equilibrium:
    return find_equilibrium(model, POINT)


def test_the_web_is_as_large_and_as_heavy_as_the_gear(
    model: GearModel, steady: Equilibrium
) -> None:
    web = web_of(model, steady.state, steady.tow, 0.8)
    assert len(web.lines) == len(model.ends)
    assert len(web.points) == model.nodes + COUPLED
    rest = np.where(model.warp_side >= 0, 500.0 / model.warp_segments, model.rest)
    assert sum(web.kinds[line.kind].mass * line.length for line in web.lines) == pytest.approx(
        model.bars.mass @ rest
    )
    drag = sum(
        web.kinds[line.kind].drag * web.kinds[line.kind].diameter * line.length
        for line in web.lines
    )
    assert drag == pytest.approx(model.bars.normal_drag * model.bars.normal_area @ rest)


def test_the_web_stays_in_the_steady_state_of_the_gear(
    model: GearModel, steady: Equilibrium
) -> None:
    pytest.importorskip('moordyn')
    assert np.abs(forces(model, steady.state, steady.tow)).max() < 1e-3
    web = web_of(model, steady.state, steady.tow, 0.8)
    pulls, _ = towed(web, 'RK4', 0.002, 0.5)
    sizes = np.linalg.norm(pulls, axis=2)
    # The kite is missing, and MoorDyn has the drag of a bar at its ends.
    assert sizes[-1] == pytest.approx(sizes[0], rel=0.1)
    port, starboard = sizes[:, :3], sizes[:, 3:6]
    assert port == pytest.approx(starboard, rel=1e-3)


def test_the_row_is_the_factor_of_the_best_scheme() -> None:
    pytest.importorskip('moordyn')
    rows = measure(quick=True).rows
    assert rows[0].value == max(row.value for row in rows) == moordyn_web_factor(quick=True)
    assert rows[0].value > 1.0
    assert 'largest stable step' in rows[1].note
