# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Growth of time and memory as the net is refined, around and along together."""

import sys
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.lab.benchmark.gears import default_gear
from trawl_ros.lab.benchmark.haul import START, haul_of
from trawl_ros.lab.report.measured import MeasuredValue, at_least, at_most
from trawl_ros.lab.report.page import Findings
from trawl_ros.lab.running.timing import factor_cost, median_s
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.report.pictures import Drawing
from trawl_ros.solver.equilibrium import find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint
from trawl_ros.solver.stepper import StepFailed

MESHES_AROUND = (12, 24, 36, 48, 72, 84, 96, 108)
"""Meshes around, for less than 150 to more than 5000 net nodes; rows keep the mesh angle."""

MOST_NODES = 5000.0

EXPONENT = 1.3
STEP_S = 0.2


@dataclass(frozen=True)
class GrowthSize:
    """Costs of one refinement of the net.

    Attributes
    ----------
    around
        Meshes around the mouth.
    nodes
        Nodes in the net.
    step_s
        CPU time of a time step, s.
    warm_s, iterations
        CPU time (s) and iterations of a steady state, started from one with 20 m less warp.
    factor_s
        CPU time of one factorisation and its solution, s.
    factor_mb
        Size of the factors, MB.
    peak_mb
        Peak memory of the process, MB.
    """

    around: int
    nodes: int
    step_s: float
    warm_s: float
    iterations: int
    factor_s: float
    factor_mb: float
    peak_mb: float


def measure(quick: bool) -> Findings:
    """Measure one refinement after another."""
    gear = default_gear(quick=False)
    sizes, refused = [], 'no finer one was tried'
    for around in MESHES_AROUND[:2] if quick else MESHES_AROUND:
        model = build_model(gear.changed('netting', around=around))
        try:
            sizes.append(_size(model, quick=quick))
        except (NoSteadyState, StepFailed) as error:
            refused = f'{len(model.layout.net)} net nodes: {error}'
    last = sizes[-1]
    span = f'{sizes[0].nodes} to {last.nodes} net nodes'
    step = exponent([size.nodes for size in sizes], [size.step_s for size in sizes])
    warm = exponent([size.nodes for size in sizes], [size.warm_s for size in sizes])
    linear = exponent([size.nodes for size in sizes], [size.factor_s for size in sizes])
    upper = sizes[-max(2, len(sizes) // 2) :]
    span_there = f'{upper[0].nodes} to {last.nodes} net nodes'
    step_there = exponent([s.nodes for s in upper], [s.step_s for s in upper])
    warm_there = exponent([s.nodes for s in upper], [s.warm_s for s in upper])
    linear_there = exponent([s.nodes for s in upper], [s.factor_s for s in upper])
    slower = (
        f'there one factorisation with its solution has {linear_there:.2f}, and '
        'that of a sheet by nested dissection tends to 1.5'
    )
    rows = (
        MeasuredValue(
            'net nodes of the largest net', last.nodes, target=at_least(MOST_NODES), note=refused
        ),
        MeasuredValue(
            'exponent of the time per step in the number of net nodes, finer half of the sizes',
            step_there,
            target=at_most(EXPONENT),
            note=f'{span_there}, hauling in steps of {STEP_S:g} s; {1e3 * sizes[0].step_s:.1f} to '
            f'{1e3 * last.step_s:.0f} ms over all sizes, {span}, with exponent {step:.2f}; '
            f'{slower}',
        ),
        MeasuredValue(
            'exponent of the time per steady state, warm, finer half of the sizes',
            warm_there,
            target=at_most(EXPONENT),
            note=f'{span_there}; {1e3 * sizes[0].warm_s:.0f} to {1e3 * last.warm_s:.0f} ms over '
            f'all sizes, {span}, with exponent {warm:.2f}; {slower}, and iterations are '
            f'{", ".join(str(size.iterations) for size in upper)}, by which bars become slack or '
            'taut on the way',
        ),
        MeasuredValue(
            'exponent of one factorisation and solution',
            linear,
            note=f'{1e3 * sizes[0].factor_s:.2f} to {1e3 * last.factor_s:.0f} ms; over the finer '
            f'half {linear_there:.2f}',
        ),
        MeasuredValue(f'memory of the factors at {last.nodes} net nodes', last.factor_mb, 'MB'),
        MeasuredValue(
            f'most memory of the process up to {last.nodes} net nodes',
            last.peak_mb,
            'MB',
            note='interpreter, libraries and what was measured before included',
        ),
    )
    return Findings(
        rows,
        (Drawing('nodes', 'Time and memory against the number of net nodes.', _draw(sizes)),),
        text='Meshes around the net are refined and rows along it with them; warps and bridles '
        'stay as they are. Exponents are slopes of straight lines through the logarithms.',
    )


def exponent(nodes: Sequence[int], values: Sequence[float]) -> float:
    """Exponent of growth: slope of the straight line through the logarithms."""
    return float(np.polyfit(np.log(nodes), np.log(values), 1)[0])


def _size(model: GearModel, *, quick: bool) -> GrowthSize:
    steps, repeats = (4, 1) if quick else (40, 3)
    known = find_equilibrium(model, START)
    haul = haul_of(model, steps * STEP_S, known)
    longer = START.port_length + 20.0
    point = OperatingPoint(longer, longer, START.speed)
    factor_s, factor_mb = factor_cost(model, known.state, known.tow, repeats)
    return GrowthSize(
        around=model.gear.netting.around,
        nodes=len(model.layout.net),
        step_s=median_s(lambda: haul.run(STEP_S), repeats) / steps,
        warm_s=median_s(lambda: find_equilibrium(model, point, known), repeats),
        iterations=find_equilibrium(model, point, known).iterations,
        factor_s=factor_s,
        factor_mb=factor_mb,
        peak_mb=peak_mb(),
    )


def peak_mb() -> float:
    """Largest resident memory of this process so far, MB; NaN if the system does not provide it."""
    if sys.platform == 'win32':
        return float('nan')
    import resource

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / 1e6 if sys.platform == 'darwin' else peak * 1024 / 1e6


def _draw(sizes: Sequence[GrowthSize]) -> Figure:
    figure = Figure(figsize=(9.0, 4.0), layout='constrained')
    left, right = figure.subplots(1, 2)
    nodes = np.array([size.nodes for size in sizes])
    for label, values in (
        ('steady state, warm', [size.warm_s for size in sizes]),
        ('time step', [size.step_s for size in sizes]),
        ('one factorisation', [size.factor_s for size in sizes]),
    ):
        slope = exponent([size.nodes for size in sizes], values)
        left.loglog(nodes, values, 'o-', label=f'{label}: exponent {slope:.2f}')
    left.set(xlabel='nodes of the net', ylabel='CPU time [s]')
    right.loglog(nodes, [size.factor_mb for size in sizes], 'o-', label='factors')
    right.loglog(nodes, [size.peak_mb for size in sizes], 's--', label='most of the process so far')
    right.set(xlabel='nodes of the net', ylabel='memory [MB]')
    for axes in (left, right):
        axes.grid(alpha=0.3, which='both')
        axes.legend()
    return figure
