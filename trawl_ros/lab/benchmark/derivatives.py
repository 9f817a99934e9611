# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Time of a step with and without the derivatives of the motion by twenty parameters."""

import gc
import tracemalloc
from dataclasses import dataclass

import numpy as np

from trawl_ros.effects.registry import catalogue
from trawl_ros.lab.benchmark.gears import default_gear
from trawl_ros.lab.benchmark.haul import FINEST_S, HaulManoeuvre, haul_of
from trawl_ros.lab.report.measured import MeasuredValue, TargetRange, at_most
from trawl_ros.lab.report.page import Findings
from trawl_ros.lab.running.timing import Part, shares, timed
from trawl_ros.model.assembly import linearised
from trawl_ros.model.gear_model import build_model
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.solver.linear.factor import Factor, factorised
from trawl_ros.solver.motion.course import InputPoint, course_point
from trawl_ros.solver.motion.parameters import MotionParameters
from trawl_ros.solver.motion.partials import effect_pushes, pushes
from trawl_ros.solver.motion.tow import DifferentiatedTow

STEP_S = 0.2
"""Step of `sim_node` and `trawl tow`."""

STEP_MS = 6.0

EFFECTS = ('board_added_mass', 'counter_scale', 'counter_offset', 'speed_log')
TWENTY = MotionParameters(
    coefficients=COEFFICIENTS, net=True, effects=tuple(catalogue()[name] for name in EFFECTS)
)
"""Twelve coefficients, drag and weight of the net, added mass, errors of counters and log."""

MEMORY_RATIO = 1.05

PARTS: dict[str, Part] = {
    'factorisations': factorised,
    'solutions': Factor.solve,
    'derivatives of the forces': linearised,
    'forces by parameters': pushes,
    'forces by effects': effect_pushes,
    'boundary and its derivatives': course_point,
}
"""Main functions of a step with derivatives."""

NONE = MotionParameters()


@dataclass(frozen=True)
class RecordedInputs:
    """Inputs of a manoeuvre as a function of time."""

    haul: HaulManoeuvre

    def __call__(self, time: float) -> InputPoint:
        """Return the inputs at a time, s."""
        tow = self.haul.tows[round(time / FINEST_S)]
        speed = float(np.hypot(*tow.block_velocities[0, :2]))
        return InputPoint(
            np.array([*tow.lengths, speed]), np.array([*tow.length_rates, 0.0]), hours=time / 3600
        )


def measure(quick: bool) -> Findings:
    """Tow with and without derivatives, alternately, several times."""
    steps, repeats = (10, 2) if quick else (300, 5)
    model = build_model(default_gear(quick=quick))
    inputs = RecordedInputs(haul_of(model, steps * STEP_S))
    times = np.empty((2, repeats, steps))
    for repeat in range(repeats):
        for number, parameters in enumerate((NONE, TWENTY)):
            tow = DifferentiatedTow(model, parameters, inputs)
            times[number, repeat] = [_step_s(tow) for _ in range(steps)]
    tow = DifferentiatedTow(model, TWENTY, inputs)
    taken = shares(lambda: [_step_s(tow) for _ in range(steps)], PARTS)
    # Other programs lengthen some steps of some repeats, never all of one step.
    alone, along = 1e3 * times.min(axis=1).mean(axis=1)
    return Findings(
        (
            MeasuredValue(
                f'a step of {STEP_S:g} s with derivatives by {len(TWENTY)} parameters',
                along,
                'ms',
                at_most(STEP_MS),
                f'mean of {steps} steps of hauling, each the least of {repeats}; of state and '
                f'observables; {model.dof} degrees of freedom; {taken}',
            ),
            MeasuredValue('the same step without derivatives', alone, 'ms'),
            MeasuredValue(
                'memory of a tow with derivatives, after all steps over after one',
                *_memory(DifferentiatedTow(model, TWENTY, inputs), steps),
            ),
        ),
        text='Derivatives by ' + ', '.join(TWENTY.names) + '.',
    )


def _step_s(tow: DifferentiatedTow) -> float:
    """CPU time (s) of a step; with derivatives, the observation after it is included."""

    def step() -> None:
        tow.advance(STEP_S)
        if tow.parameters:
            tow.observed()

    return timed(step)[1]


def _memory(tow: DifferentiatedTow, steps: int) -> tuple[float, str, TargetRange, str]:
    """Memory (as a ratio) of a tow, with unit, target and note of its row."""
    tracemalloc.start()
    try:
        held = []
        for number in (1, steps - 1):
            for _ in range(number):
                tow.advance(STEP_S)
            gc.collect()
            held.append(tracemalloc.get_traced_memory()[0])
    finally:
        tracemalloc.stop()
    note = f'{held[-1] / 1e6:.2f} MB after {steps} steps, {held[0] / 1e6:.2f} after one'
    return held[-1] / held[0], '×', at_most(MEMORY_RATIO), note
