"""The eigenvalues sought near instability are the least stable ones of all."""

import numpy as np
import pytest
import scipy.linalg

from trawl_ros.gear.records import GearRecord
from trawl_ros.model.assembly import linearised, mass
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.solver.equilibrium import find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint
from trawl_ros.solver.stability import stability


def all_eigenvalues(model: GearModel, state, tow) -> np.ndarray:
    """Every eigenvalue of M ẍ + C ẋ + K x = 0, by a dense first-order form."""
    here, matrix = linearised(model, state, tow), model.pattern.matrix
    inertia = matrix(mass(model, state, tow)).toarray()
    k, c = (
        scipy.linalg.solve(inertia, matrix(data).toarray(), assume_a='pos')
        for data in (here.stiffness, here.damping)
    )
    n = model.dof
    return np.linalg.eigvals(np.block([[np.zeros((n, n)), np.eye(n)], [-k, -c]]))


@pytest.mark.parametrize(('factor_of_b3', 'stable'), [(1.0, True), (-2.0, False)])
def test_growth_is_that_of_all_eigenvalues(
    gear: GearRecord, factor_of_b3: float, stable: bool
) -> None:
    coarse = build_model(
        gear.model_copy(
            update={
                'warp': gear.warp.model_copy(update={'segments': 4}),
                'bridle': gear.bridle.model_copy(update={'segments': 2}),
                'netting': gear.netting.model_copy(update={'around': 12}),
            }
        )
    )
    # With the other sign the board is pushed on by flow along its span.
    values = coarse.coefficients.copy()
    values[COEFFICIENTS.index('b3')] *= factor_of_b3
    model = coarse.with_coefficients(values)
    start = find_equilibrium(coarse, OperatingPoint(500.0, 500.0, 2.1))
    found = find_equilibrium(model, OperatingPoint(500.0, 500.0, 2.1), start)
    near = stability(model, found.state, found.tow)
    everything = all_eigenvalues(model, found.state, found.tow)
    assert near.growth == pytest.approx(everything.real.max(), rel=1e-4)
    assert near.stable is stable
    if stable:
        assert near.settling_time == pytest.approx(-1.0 / near.growth)
    else:
        assert near.settling_time == np.inf
