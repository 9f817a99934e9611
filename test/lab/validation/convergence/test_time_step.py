"""The case on the time step: the smooth manoeuvre is smooth, and an order is read off rightly."""

import json

import numpy as np
import pytest

from trawl_ros.lab.validation.convergence.time_step import (
    CASE,
    SteppedManoeuvre,
    convergence,
    smooth_tow,
)
from trawl_ros.lab.validation.run import check_record
from trawl_ros.model.gear_model import GearModel
from trawl_ros.solver.operating_point import OperatingPoint, steady_tow


@pytest.mark.slow
def test_every_check_of_the_small_case_holds() -> None:
    outcome = CASE.run(True)
    assert [check.key for check in outcome.rows if not check.ok] == []
    json.dumps([check_record(check) for check in outcome.rows])


def test_the_smooth_manoeuvre_moves_as_its_rates_say(model: GearModel) -> None:
    start = steady_tow(model, OperatingPoint(500.0, 500.0, 2.1))
    duration, dt = 32.0, 1e-4
    for t in (0.0, 5.0, 16.0, 31.0):
        before, now, after = (smooth_tow(model, start, t + d, duration) for d in (-dt, 0.0, dt))
        np.testing.assert_allclose(
            (after.lengths - before.lengths) / (2 * dt), now.length_rates, atol=1e-7
        )
        np.testing.assert_allclose(
            (after.blocks - before.blocks) / (2 * dt), now.block_velocities, atol=1e-7
        )
    middle = smooth_tow(model, start, 16.0, duration)
    assert -middle.length_rates.min() == pytest.approx(model.gear.winch.max_speed_m_s)
    for t in (0.0, duration):
        np.testing.assert_allclose(
            smooth_tow(model, start, t, duration).length_rates, 0.0, atol=1e-12
        )


@pytest.mark.parametrize('order', [1.0, 2.0, 3.0])
def test_the_order_is_that_of_the_errors(order: float) -> None:
    rng = np.random.default_rng(1)
    exact, shape = rng.normal(size=(5, 24)), rng.normal(size=(5, 24))
    runs = [
        SteppedManoeuvre(
            step, exact + shape * step**order, (exact + shape * step**order)[:, None, :3], tension
        )
        for step, tension in ((0.4, 5.0), (0.2, 3.0), (0.1, 4.0), (0.0, 6.0))
    ]
    found = convergence(runs)
    np.testing.assert_allclose(found.orders(), order)
    assert found.order(found.norm) == pytest.approx(order)
    assert found.order(found.places.max(1)) == pytest.approx(order)
    np.testing.assert_allclose(found.place_orders(), order)
    assert found.tension == 3.0
    changes = np.ptp(exact, axis=0)
    np.testing.assert_allclose(
        found.errors[2], np.abs(shape).max(0) * 0.1**order / changes, rtol=1e-9
    )
