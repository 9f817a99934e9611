"""Steps of a fitted tow: their damping, and their length."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.model.gear_model import GearModel
from trawl_ros.solver.equilibrium import SteadyState
from trawl_ros.solver.motion import stepper as module
from trawl_ros.solver.motion.course import InputPoint
from trawl_ros.solver.motion.parameters import MotionParameters
from trawl_ros.solver.motion.stepper import DifferentiatedStepper, is_too_long
from trawl_ros.solver.motion.tow import DifferentiatedTow
from trawl_ros.solver.stepper import (
    SCHEME,
    Scheme,
    SolvedStep,
    Step,
    StepFailed,
    StepperOptions,
    at_rest,
)

NONE = MotionParameters()


def hauling(time: float) -> InputPoint:
    """Winches that haul at 1 m/s from one instant to the next."""
    length = 500.0 - max(time - 3.0, 0.0)
    return InputPoint(np.array([length, length, 2.1]), np.array([-1.0, -1.0, 0.0]) * (time > 3.0))


@pytest.mark.parametrize('side', [0, 1])
def test_a_step_that_leads_a_board_away_is_too_long(steady: SteadyState, side: int) -> None:
    motion = at_rest(steady.equilibrium.state)
    step = Step(motion, 6.0, module.DAMPED)
    none = SolvedStep(step, np.zeros_like(motion.acceleration), np.zeros(0))
    assert not is_too_long(motion, none)
    boards = len(motion.acceleration) - 12
    for place, little, much in ((0, 0.09, 0.11), (5, np.radians(0.9), np.radians(1.1))):
        for way, too_long in ((little, False), (much, True), (-much, True)):
            new = np.zeros_like(motion.acceleration)
            new[boards + 6 * side + place] = way / step.scheme.by_position(step.h)
            assert is_too_long(motion, replace(none, acceleration=new)) == too_long


def test_a_tow_is_led_in_shorter_steps_where_winches_start(
    model: GearModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    taken, failed = steps_of(DifferentiatedTow(model, NONE, hauling), monkeypatch)
    assert sum(taken) == pytest.approx(9.0)
    assert taken[0] == 3.0
    assert min(taken) < 3.0
    assert failed


def steps_of(
    tow: DifferentiatedTow, monkeypatch: pytest.MonkeyPatch
) -> tuple[list[float], list[float]]:
    """Lengths of the steps that a tow of 9 s takes, and of those that fail."""
    taken, failed = [], []
    solved = DifferentiatedStepper._solved

    def noted(self, motion, tow, h):
        try:
            found = solved(self, motion, tow, h)
        except StepFailed:
            failed.append(h)
            raise
        taken.append(h)
        return found

    with monkeypatch.context() as patched:
        patched.setattr(DifferentiatedStepper, '_solved', noted)
        for _ in range(3):
            tow.advance(3.0)
    assert tow.time == pytest.approx(9.0)
    return taken, failed


@pytest.mark.parametrize(('h', 'most'), [(3.0, 1), (0.2, 2)])
def test_a_step_that_fails_is_tried_again_in_another_way_alone(
    model: GearModel, steady: SteadyState, h: float, most: int
) -> None:
    found = steady.equilibrium
    torn = replace(found.tow, lengths=found.tow.lengths - 200.0)
    stepper = DifferentiatedStepper(model)
    with pytest.raises(StepFailed):
        stepper.step(at_rest(found.state), torn, h)
    # Long steps take a matrix for each iteration at once; short ones, where they failed with one.
    assert most - 1 < stepper.factorisations / StepperOptions().full_newton_iterations <= most


def test_what_vibrates_faster_than_long_steps_is_damped_more_than_in_a_simulation() -> None:
    assert left_of_fast(SCHEME) == pytest.approx(0.4, rel=0.01)
    assert left_of_fast(DifferentiatedStepper.scheme) == pytest.approx(0.2, rel=0.01)


def left_of_fast(scheme: Scheme) -> float:
    """Spectral radius of a step of a mass on a spring of a thousand oscillations in it."""
    h, stiffness = 1.0, (2000.0 * np.pi) ** 2
    rows = []
    for velocity, place, acceleration, averaged in np.eye(4):
        known = scheme.known_acceleration(acceleration, averaged)
        way = scheme.predicted_displacement(velocity, averaged, known, h)
        pace = scheme.predicted_velocity(velocity, averaged, known, h)
        new = -stiffness * (place + way) / (1.0 + stiffness * scheme.by_position(h))
        rows.append(
            (
                pace + scheme.by_velocity(h) * new,
                place + way + scheme.by_position(h) * new,
                new,
                known + scheme.share * new,
            )
        )
    return float(np.abs(np.linalg.eigvals(np.array(rows).T)).max())
