# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Steady states of the full gear, warm and cold, compared with codes that solve less."""

import math
from collections.abc import Callable
from functools import partial
from itertools import cycle
from statistics import median

from trawl_ros.lab.benchmark.gears import default_gear
from trawl_ros.lab.reference_codes.absent import PeerAbsent, PeerFailed, peer
from trawl_ros.lab.reference_codes.moorpy_wire import MoorPyWire
from trawl_ros.lab.reference_codes.towed_wire import TowedWire
from trawl_ros.lab.report.measured import MeasuredValue, at_least, at_most
from trawl_ros.lab.report.page import Findings
from trawl_ros.lab.running.timing import Part, median_s, shares, timed
from trawl_ros.model.assembly import forces, linearised
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.solver.equilibrium import Equilibrium, SteadyState, find_equilibrium, steady_state
from trawl_ros.solver.linear.factor import Factor, factorised
from trawl_ros.solver.operating_point import OperatingPoint
from trawl_ros.solver.sensitivity import sensitivities
from trawl_ros.solver.stability import SWINGING, stability

WARM_MS, SENSITIVITIES_MS = 12.0, 20.0
COLD_S, STABLE_S = 0.2, 0.25
OVER_TRAWLKIT = 50.0

CHANGES = ((20.0, 0.0), (-20.0, 0.0), (0.0, 0.05), (0.0, -0.05), (100.0, 0.0), (-100.0, 0.0))
"""Changes of warp length (m) and speed (m/s), from 500 m and 2.1 m/s."""

COLD_POINTS = ((300.0, 2.1), (500.0, 1.9), (500.0, 2.1), (700.0, 2.1), (900.0, 2.1))

KERNEL_REPEATS = 21

PARTS: dict[str, Part] = {
    'factorisations': factorised,
    'derivatives of the forces': linearised,
    'forces': forces,
    'solutions': Factor.solve,
}
"""Main functions of a search for a steady state."""

TRAWLKIT_COARSE = 2
"""Divisions per panel of the small version; the default is trawlkit's own."""


def _point(length: float, speed: float) -> OperatingPoint:
    return OperatingPoint(length, length, speed)


def measure(quick: bool) -> Findings:
    """Time steady states from a known one, from a cold start, and with the check of stability."""
    model = build_model(default_gear(quick=quick))
    repeats = 1 if quick else 5
    known = find_equilibrium(model, _point(500.0, 2.1))
    warm = [_warm_s(model, known, change, repeats) for change in CHANGES]
    derived = [_warm_s(model, known, change, repeats, sensitivities) for change in CHANGES]
    points = COLD_POINTS[2:3] if quick else COLD_POINTS
    cold = [median_s(_cold(model, *point), 1 if quick else 3) for point in points]
    usable = [median_s(_usable(model, *point), 1 if quick else 3) for point in points]
    near = median_s(lambda: steady_state(model, 520.0, 2.1, start=known), repeats)
    kernels = _kernels(model, known)
    counts = [find_equilibrium(model, _point(500.0 + dl, 2.1 + du), known).iterations
              for dl, du in CHANGES]  # fmt: skip
    size = f'{model.nodes} nodes, {len(model.ends)} bars, two boards in 6-DOF'
    rows = [
        MeasuredValue(
            'steady state of the full gear, warm',
            1e3 * median(warm),
            'ms',
            at_most(WARM_MS),
            f'{size}; median over {len(CHANGES)} changes of warp length (±20, ±100 m) and speed '
            f'(±0.05 m/s), {1e3 * min(warm):.0f} to {1e3 * max(warm):.0f} ms; '
            f'{min(counts)} to {max(counts)} iterations, {kernels}; bars that become slack '
            'or taut on the way ask for derivatives and factorisation again',
        ),
        MeasuredValue(
            'the same, warm, with the derivatives by all parameters',
            1e3 * median(derived),
            'ms',
            at_most(SENSITIVITIES_MS),
            f'{len(model.coefficients) + 3} of them; {1e3 * min(derived):.0f} to '
            f'{1e3 * max(derived):.0f} ms; '
            f'{1e3 * (median(derived) - median(warm)):.0f} ms for one factorisation, the solution '
            'for all of them and the observables along each',
        ),
        MeasuredValue(
            'the same, cold',
            median(cold),
            's',
            at_most(COLD_S),
            f'from a first guess; median over {len(points)} operating points, slowest '
            f'{max(cold):.2f} s; {_of_cold(model)}',
        ),
        MeasuredValue(
            'the same, cold, with the check of stability',
            median(usable),
            's',
            at_most(STABLE_S),
            f'slowest {max(usable):.2f} s; {median(usable) - median(cold):.2f} s for the '
            f'eigenvalues around {2 + len(SWINGING)} points, each a '
            f'factorisation and the solutions of an Arnoldi search, complex ones '
            f'around {len(SWINGING)} of them: {_of_stability(model, known)}',
        ),
        MeasuredValue(
            'the same, warm, with the check of stability', 1e3 * near, 'ms', note='+20 m of warp'
        ),
    ]
    rows += _beside_trawlkit(median(warm), median(cold), quick=quick)
    rows += _beside_moorpy(median(warm), quick=quick)
    return Findings(
        tuple(rows),
        text='A warm start begins at a known steady state nearby, whose factorisation is at hand '
        'or, as in a fit, its derivatives; a cold one begins with straight ropes. All end at the '
        'same residual. trawlkit solves another and smaller problem, a bottom trawl of its own by '
        'dynamic relaxation with doors as points, each speed starting from the one '
        'before; MoorPy one wire alone.',
    )


def _kernels(model: GearModel, known: Equilibrium) -> str:
    """Return the times of the parts of an iteration in words."""
    at = model, known.state, known.tow
    here = linearised(*at)
    factor = factorised(model.pattern, here.stiffness)
    works: dict[str, Callable[[], object]] = {
        'forces': lambda: forces(*at),
        'their derivatives': lambda: linearised(*at),
        'a factorisation': lambda: factorised(model.pattern, here.stiffness),
        'a solution': lambda: factor.solve(here.force),
    }
    times = [f'{name} {1e3 * median_s(work, KERNEL_REPEATS):.2f}' for name, work in works.items()]
    return ', '.join(times) + ' ms'


def _of_cold(model: GearModel) -> str:
    """Parts of a cold start in words."""
    point, found = _point(500.0, 2.1), []
    taken = shares(lambda: found.append(find_equilibrium(model, point)), PARTS)
    return (
        f'at 500 m and 2.1 m/s {found[0].iterations} iterations, on nets of half and a quarter '
        f'the meshes first, then with twine that bows less and less: {taken}'
    )


def _of_stability(model: GearModel, known: Equilibrium) -> str:
    """Parts of the check of stability in words."""
    parts: dict[str, Part] = {'factorisations': factorised, 'solutions': Factor.solve}
    return shares(lambda: stability(model, known.state, known.tow), parts)


def _warm_s(
    model: GearModel,
    known: Equilibrium,
    change: tuple[float, float],
    repeats: int,
    then: Callable[[GearModel, Equilibrium], object] | None = None,
) -> float:
    point = _point(500.0 + change[0], 2.1 + change[1])

    def work() -> None:
        found = find_equilibrium(model, point, known)
        if then is not None:
            then(model, found)

    return median_s(work, repeats)


def _cold(model: GearModel, length: float, speed: float) -> Callable[[], Equilibrium]:
    return lambda: find_equilibrium(model, _point(length, speed))


def _usable(model: GearModel, length: float, speed: float) -> Callable[[], SteadyState]:
    return lambda: steady_state(model, length, speed)


def _beside_trawlkit(warm_s: float, cold_s: float, *, quick: bool) -> list[MeasuredValue]:
    what = "trawlkit's time for one speed, over the warm steady state"
    try:
        times = trawlkit_s(quick=quick)
    except PeerAbsent as absent:
        return [MeasuredValue(what, math.nan, '×', at_least(OVER_TRAWLKIT), str(absent))]
    peer = median(times)
    note = (
        f'trawlkit {peer:.1f} s, {min(times):.1f} to {max(times):.1f} s over {len(times)} speeds '
        'of its example, doors coupled'
    )
    return [
        MeasuredValue(what, peer / warm_s, '×', at_least(OVER_TRAWLKIT), note),
        MeasuredValue('the same, over the cold steady state', peer / cold_s, '×', note=note),
    ]


def trawlkit_s(*, quick: bool) -> list[float]:
    """CPU time (s) of each speed in trawlkit's own example; all but the first start warm."""
    trawlkit, sim = peer('trawlkit'), peer('trawlkit.sim')
    case = trawlkit.run(peer('trawlkit.sim.validation').standard_case())
    start, times = None, []
    for knots in (3.0,) if quick else (2.0, 2.5, 3.0, 3.5, 4.0):
        solve = partial(
            sim.simulate, case, knots, scenario=sim.Scenario(), x_init=start,
            resolution=TRAWLKIT_COARSE if quick else sim.DEFAULT_RESOLUTION,
        )  # fmt: skip
        found, seconds = timed(solve)
        start = found.nodes
        times.append(seconds)
    return times


def _beside_moorpy(warm_s: float, *, quick: bool) -> list[MeasuredValue]:
    what = "MoorPy's time for one wire alone, warm, over the warm steady state of the gear"
    try:
        seconds = moorpy_s(1 if quick else 5)
    except (PeerAbsent, PeerFailed) as error:
        return [MeasuredValue(what, math.nan, '×', note=str(error))]
    note = f'MoorPy {1e3 * seconds:.0f} ms, 20 m more or less of a towed wire of 600 m'
    return [MeasuredValue(what, seconds / warm_s, '×', note=note)]


def moorpy_s(repeats: int) -> float:
    """CPU time (s) of MoorPy for a towed wire whose length has changed by 20 m."""
    wire = MoorPyWire(TowedWire())
    wire.solve()
    lengths = cycle((620.0, 600.0))
    return median_s(lambda: wire.solve(next(lengths)), repeats)
