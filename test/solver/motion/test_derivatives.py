"""Derivatives of a tow by parameters against tows with each parameter changed."""

import gc
import tracemalloc
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.linalg import block_diag

from trawl_ros.core.arrays import FloatArray
from trawl_ros.diagnosis.inference.candidates import Candidate
from trawl_ros.effects.effect_set import ActiveEffect, EffectSet
from trawl_ros.effects.registry import catalogue
from trawl_ros.estimation.fit.error_terms import model_errors
from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.observables import observe
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.equilibrium import Equilibrium
from trawl_ros.solver.first_guess import at_velocity
from trawl_ros.solver.motion.course import InputPoint, course_point
from trawl_ros.solver.motion.parameters import MotionParameters
from trawl_ros.solver.motion.stepper import DAMPED, LinearisedStepOptions
from trawl_ros.solver.motion.tow import DifferentiatedTow, decaying_courses, slow_motions
from trawl_ros.solver.relax import relax
from trawl_ros.solver.stepper import StepFailed, Stepper, at_rest

STEP_S = 0.2
EFFECTS = ('board_added_mass', 'counter_scale', 'counter_offset', 'other_wire', 'speed_log')
PARAMETERS = MotionParameters(
    coefficients=COEFFICIENTS,
    net=True,
    effects=tuple(catalogue()[name] for name in EFFECTS),
    inputs=('speed drift',),
)
ADDED = ActiveEffect(catalogue()['board_added_mass'], np.array([0.5]))
ACTING = EffectSet((ADDED,))


def smooth(time: float, begin: float, end: float) -> tuple[float, float]:
    """Part of a change that is done, and its rate."""
    x = min(max((time - begin) / (end - begin), 0.0), 1.0)
    return x * x * (3 - 2 * x), (6 * x - 6 * x * x) / (end - begin)


def hauling(time: float) -> InputPoint:
    """Hauls unequally while the ship slows down, and veers after four minutes."""
    port, starboard = np.array([-60.0, 40.0]), np.array([-55.0, 40.0])
    done, rate = np.array([smooth(time, 10.0, 100.0), smooth(time, 250.0, 330.0)]).T
    slower, slowing = smooth(time, 20.0, 60.0)
    minutes = time / 60.0
    return InputPoint(
        inputs=np.array([500.0 + port @ done, 500.0 + starboard @ done, 2.1 - 0.1 * slower]),
        rates=np.array([port @ rate, starboard @ rate, -0.1 * slowing]),
        hours=time / 3600.0,
        errors=np.array([[0.0, 0.0, minutes]]),
        error_rates=np.array([[0.0, 0.0, 1.0 / 60.0]]),
    )


@dataclass(frozen=True)
class Differentiated:
    """Observables (n, n_observables) every five seconds, their derivatives, the lengths of all
    steps that were taken, and the equilibrium at the start.
    """

    values: np.ndarray
    slopes: np.ndarray
    steps: tuple[tuple[float, ...], ...]
    first: Equilibrium


TO_ROUNDING = LinearisedStepOptions(tolerance=1e-8, root_tolerance_ratio=1.0)
"""Leaves of a difference only what the parameter itself makes."""


def differentiated(
    model: GearModel, duration_s: float, options: LinearisedStepOptions = TO_ROUNDING
) -> Differentiated:
    tow = DifferentiatedTow(model, PARAMETERS, hauling, ACTING, options=options)
    seen, steps = [], []
    for number in range(1, round(duration_s / STEP_S) + 1):
        steps.append(tuple(halved(tow.step, STEP_S)))
        if number % 25 == 0:
            seen.append(tow.observed())
    return Differentiated(
        np.array([one.values for one in seen]),
        np.array([one.slopes for one in seen]),
        tuple(steps),
        tow.first,
    )


def halved(step: Callable[[float], None], h: float) -> list[float]:
    """Take a step, in halves where it fails, and say which were taken."""
    try:
        step(h)
    except StepFailed:
        return halved(step, h / 2) + halved(step, h / 2)
    return [h]


@dataclass(frozen=True)
class Changed:
    """Gear, effects and inputs with one parameter changed."""

    model: GearModel
    acting: EffectSet
    drift: float = 0.0


def changed(model: GearModel, name: str, change: float) -> Changed:
    place = PARAMETERS.names.index(name)
    if place < 12:
        values = model.coefficients.copy()
        values[place] += change
        return Changed(model.with_coefficients(values), ACTING)
    if name in ('drag', 'weight'):
        drag, weight = (1.0 + change * (name == factor) for factor in ('drag', 'weight'))
        return Changed(model.with_net(drag, weight), ACTING)
    if name == 'speed drift':
        return Changed(model, ACTING, change)
    effect, _, value = name.partition(' ')
    active = ACTING.of(catalogue()[effect])
    place = [own.name for own in active.effect.parameters].index(value)
    values = active.values.copy()
    values[place] += change
    return Changed(model, ACTING.having(ActiveEffect(active.effect, values)))


def towed_again(run: Differentiated, case: Changed) -> np.ndarray:
    """Observables of the tow with the plain stepper, in the steps of the one with derivatives."""
    none = MotionParameters()

    def inputs(time: float) -> InputPoint:
        point = hauling(time)
        return InputPoint(
            point.inputs + case.drift * point.errors[0],
            point.rates + case.drift * point.error_rates[0],
            hours=point.hours,
        )

    course = course_point(case.model, case.acting, none, inputs(0.0))
    model = case.acting.gear(case.model, inputs(0.0).situation)
    start = at_velocity(run.first.state, course.tow.block_velocities[0])
    state, _, left = relax(model, start, course.tow, tolerance=1e-6, time_step=1e9)
    assert left < 1e-6
    stepper, motion, time, seen = Stepper(model, TO_ROUNDING), at_rest(state), 0.0, []
    stepper.scheme = DAMPED
    for number, steps in enumerate(run.steps, 1):
        for h in steps:
            time += h
            course = course_point(case.model, case.acting, none, inputs(time), course, h)
            motion = stepper.step(motion, course.tow, h)
        if number % 25 == 0:
            seen.append(observe(model, motion.state, course.tow).array())
    return np.array(seen)


STEPS = dict.fromkeys(PARAMETERS.names, 1e-5) | {
    'board_added_mass part': 1e-4,
    'counter_scale scale': 1e-6,
    'counter_scale port_more': 1e-6,
    'counter_offset offset': 5e-4,
    'speed_log scale': 3e-6,
    'speed_log bias': 3e-6,
}


def difference(model: GearModel, run: Differentiated, name: str, h: float) -> np.ndarray:
    """Central difference of fourth order (n, n_observables) of tows with a parameter changed."""
    one, two = (
        towed_again(run, changed(model, name, size)) - towed_again(run, changed(model, name, -size))
        for size in (h, 2 * h)
    )
    return (8 * one - two) / (12 * h)


def largest_error(model: GearModel, run: Differentiated, name: str) -> float:
    """Largest error of any observable at any time, as a share of its largest derivative or, where
    that nearly vanishes, of what a thousandth of the value would give.
    """
    column = run.slopes[:, :, PARAMETERS.names.index(name)]
    least = np.inf
    # Ropes that fall slack bend the tow as a function of a parameter: differences have to be taken
    # over less than lies between two of these bends.
    for shorter in (1, 5, 25):
        expected = difference(model, run, name, STEPS[name] / shorter)
        value = np.abs(run.values).max(axis=0)
        scale = np.maximum(np.abs(expected).max(axis=0), 1e-3 * value)
        least = min(least, float((np.abs(column - expected).max(axis=0) / scale).max()))
        if least < EXACT:
            break
    return least


EXACT = 1e-5

QUICK_S, LONG_S = 24.0, 600.0
CHOSEN = (
    'a4', 'drag', 'weight', 'board_added_mass part', 'counter_scale port_more', 'speed_log bias',
    'speed drift',
)  # fmt: skip

HALVED = ('c4', 'drag', 'counter_scale port_more', 'speed_log scale', 'speed drift')
"""Changed by their steps, the gear cannot be towed for ten minutes in the same time steps."""


@pytest.fixture(scope='module')
def quick(model: GearModel) -> Differentiated:
    return differentiated(model, QUICK_S)


@pytest.fixture(scope='module')
def ten_minutes(model: GearModel) -> Differentiated:
    return differentiated(model, LONG_S)


@pytest.mark.parametrize('name', CHOSEN)
def test_derivatives_while_hauling(model: GearModel, quick: Differentiated, name: str) -> None:
    assert largest_error(model, quick, name) < EXACT


@pytest.mark.slow
@pytest.mark.parametrize('name', [name for name in PARAMETERS.names if name not in HALVED])
def test_derivatives_over_ten_minutes(
    model: GearModel, ten_minutes: Differentiated, name: str
) -> None:
    assert largest_error(model, ten_minutes, name) < EXACT


def test_names_are_those_of_a_fit(quick: Differentiated) -> None:
    effects = [Candidate(catalogue()[name], np.zeros(0)).group for name in EFFECTS]
    net = model_errors(EstimatorOptions(net_drag=0.2, net_weight=0.2)).only('net')
    expected = (*COEFFICIENTS, *net.names, *(name for group in effects for name in group.names))
    assert PARAMETERS.names[:21] == expected
    assert quick.slopes.shape[2] == len(PARAMETERS)


def test_shipped_tolerance_is_as_exact(model: GearModel) -> None:
    loose = differentiated(model, QUICK_S, LinearisedStepOptions())
    tight = differentiated(model, QUICK_S, LinearisedStepOptions(tolerance=1e-7))
    value = 1e-3 * np.abs(tight.values).max(axis=0)[:, None]
    scale = np.maximum(np.abs(tight.slopes).max(axis=0), value)
    assert (np.abs(loose.slopes - tight.slopes).max(axis=0) / scale).max() < EXACT


def test_slow_motions_die_out_as_they_should(model: GearModel) -> None:
    parameters = MotionParameters(motions=2)
    tow = DifferentiatedTow(model, parameters, lambda _: hauling(0.0))
    places, paces, _ = slow_motions(tow.model, tow.first.state, tow.course.tow, 2)
    rates = np.sum(places * paces, axis=0) / np.sum(places**2, axis=0)
    first = tow.observed().slopes
    for _ in range(100):
        tow.step(STEP_S)
    left = tow.observed().slopes / first
    depth = OBSERVABLES.index('port_door_depth')
    # The doors may move against each other, which says little of the net's depth.
    np.testing.assert_allclose(left[depth], np.exp(rates * tow.time), rtol=1e-4)


def courses_of(split: float) -> tuple[FloatArray, FloatArray]:
    """Matrix with the eigenvalues -0.5, -1 ± √split, -5 and -2 ± 5i, and its slow courses."""
    rng = np.random.default_rng(3)
    pair, swing = np.array([[-1.0, split], [1.0, -1.0]]), np.array([[-2.0, 5.0], [-5.0, -2.0]])
    basis = rng.standard_normal((6, 6))
    matrix = basis @ block_diag(-0.5, pair, -5.0, swing) @ np.linalg.inv(basis)
    return matrix, decaying_courses(*np.linalg.eig(matrix))


@pytest.mark.parametrize('split', [1e-4, -1e-4])
def test_motions_are_courses_of_the_system_and_those_that_swing_are_none(split: float) -> None:
    matrix, courses = courses_of(split)
    assert len(courses) == 4
    places, paces, accelerations = courses.transpose(1, 2, 0)
    np.testing.assert_allclose(paces, matrix @ places, atol=1e-9)
    np.testing.assert_allclose(accelerations, matrix @ paces, atol=1e-9)


def test_what_slow_motions_span_does_not_jump_where_two_become_a_pair() -> None:
    spans = []
    for split in (1e-6, -1e-6):
        places = courses_of(split)[1][:3, 0].T
        spans.append(places @ np.linalg.pinv(places))
    np.testing.assert_allclose(*spans, atol=1e-4)


def test_of_a_pair_one_eigenvalue_is_enough() -> None:
    vectors = np.array([[1.0, 1.0], [0.5 + 0.1j, 0.5 - 0.1j]])
    rates = np.array([-1.0 - 0.5j, -1.0 + 0.5j])
    for kept in ([0], [1], [0, 1]):
        assert len(decaying_courses(rates[kept], vectors[:, kept])) == 2


def test_without_parameters_it_is_the_plain_tow(model: GearModel) -> None:
    plain = DifferentiatedTow(model, MotionParameters(), hauling)
    along = DifferentiatedTow(model, MotionParameters(coefficients=COEFFICIENTS), hauling)
    for _ in range(50):
        plain.advance(STEP_S)
        along.advance(STEP_S)
    np.testing.assert_allclose(along.observed().values, plain.observed().values, rtol=1e-5)
    assert plain.observed().slopes.shape == (len(OBSERVABLES), 0)


def test_a_step_that_fails_leaves_the_tow_where_it_was(model: GearModel) -> None:
    tow = DifferentiatedTow(model, MotionParameters(coefficients=COEFFICIENTS), hauling)
    tow.step(STEP_S)
    before = tow.time, tow.motion, tow.slopes, tow.course
    never = LinearisedStepOptions(iterations=0, full_newton_iterations=0)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tow._stepper, 'options', never)
        with pytest.raises(StepFailed):
            tow.advance(STEP_S)
    assert all(a is b for a, b in zip(before, (tow.time, tow.motion, tow.slopes, tow.course)))


def test_memory_does_not_grow_with_the_tow(model: GearModel) -> None:
    tow = DifferentiatedTow(model, PARAMETERS, hauling, ACTING)
    held = []
    tracemalloc.start()
    try:
        for _ in range(2):
            for _ in range(30):
                tow.advance(STEP_S)
            gc.collect()
            held.append(tracemalloc.get_traced_memory()[0])
    finally:
        tracemalloc.stop()
    assert held[1] < 1.01 * held[0]
