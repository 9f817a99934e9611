# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Trim in motion: fastening points with which boards stand while they are hauled and turned.

A board that is stable in a steady tow may still fall when a winch stops. The nine coordinates are
therefore searched by CMA-ES (Hansen 2016), an evolution strategy that takes noisy and rugged
merits. Every candidate is first trimmed for the wanted angles in the middle of the range and then
towed under random commands, the same for all candidates. Its points must also hold boards with the
coefficients from which identification starts, since the true ones are unknown.
"""

import math
from dataclasses import dataclass
from functools import partial
from itertools import product

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.core.parallel import run_tasks
from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
from trawl_ros.model.gear_model import GearModel
from trawl_ros.simulation.command import Command
from trawl_ros.simulation.heave import irregular_heave
from trawl_ros.simulation.random_commands import CommandLimits, RandomCommands
from trawl_ros.simulation.sea import Sea
from trawl_ros.simulation.simulation import CALM, Simulation
from trawl_ros.solver.equilibrium import steady_state
from trawl_ros.solver.stepper import StepFailed
from trawl_ros.solver.trim import trim
from trawl_ros.solver.trimming.held_gear import coarsest_model
from trawl_ros.solver.trimming.over_range import BOUND_TOLERANCE_M, hole_limits

FALLEN_LEAN_DEG = 90.0
"""Lean of a board that fell, and of one whose motion cannot be computed."""


@dataclass(frozen=True)
class MotionTrimOptions:
    """Options of a trim in motion.

    Attributes
    ----------
    candidates
        Riggings that are tried.
    per_generation
        Riggings of one generation of CMA-ES.
    first_step_m
        First standard deviation of a coordinate, m.
    calm_seeds, calm_s
        Seeds of the random commands in calm water, and duration of each tow, s.
    swell_seed, swell_s
        The same of one tow in swell.
    swell_height_m, swell_period_s
        Significant height and peak period of the ship's heave in it.
    part_s
        Duration of a part of a tow, s. The largest lean of each part counts.
    attack_weight
        Lean (deg) that a deviation of 1° from the wanted attack counts as, in the mean over places.
    unusable_deg
        Lean (deg) that the loss of all places counts as, by both sets of coefficients.
    beyond_limits_deg_m
        Lean (deg) that counts for each metre by which a hole lies outside its room. Such a rigging
        is not towed.
    projections
        Trims of a candidate, each from the points before moved into the room for holes.
    search_seed
        Seed of the search.
    """

    candidates: int = 144
    per_generation: int = 12
    first_step_m: float = 0.06
    calm_seeds: tuple[int, ...] = (1001, 1002, 1003, 1004)
    calm_s: float = 1200.0
    swell_seed: int = 1005
    swell_s: float = 480.0
    swell_height_m: float = 2.5
    swell_period_s: float = 9.0
    part_s: float = 120.0
    attack_weight: float = 0.5
    unusable_deg: float = 60.0
    beyond_limits_deg_m: float = 100.0
    projections: int = 12
    search_seed: int = 1


OPTIONS = MotionTrimOptions()
GLANCE_S = 5.0
"""Time between two looks at the boards, s."""

CALM_PERIOD_S, SWELL_PERIOD_S = 0.25, 0.1
"""Half of the solver's step, s."""


@dataclass(frozen=True)
class MotionTrim:
    """Rigging that was found.

    Attributes
    ----------
    points : (3, 3) array
        Points of warp, upper and lower bridle in the outward frame, m.
    lean, first_lean
        Root mean square of the largest leans of all parts of the tows (rad) with these points, and
        with those of the start.
    """

    points: FloatArray
    lean: float
    first_lean: float


@dataclass(frozen=True)
class _Wish:
    """What candidates are judged by: wanted angles (rad), middle place, all places, limits."""

    attack: float
    inclination: float
    pitch: float
    middle: tuple[float, float]
    places: tuple[tuple[float, float], ...]
    limits: CommandLimits
    options: MotionTrimOptions


def trim_in_motion(
    model: GearModel,
    *,
    attack: float,
    inclination: float,
    pitch: float = 0.0,
    warp_lengths: tuple[float, float],
    speeds: tuple[float, float],
    options: MotionTrimOptions = OPTIONS,
    on_progress: OnProgress = ignore,
) -> MotionTrim:
    """Find fastening points with which boards lean little under random commands.

    Parameters
    ----------
    model
        The gear. The search starts from its points and computes with its coarsest net.
    attack, inclination, pitch
        Wanted angles in the middle of the range, rad.
    warp_lengths, speeds
        Ends of the range of the commands, m and m/s.
    options
        Options of the search.
    on_progress
        Called after each generation.

    Returns
    -------
    MotionTrim
        The best of the candidates. Its lean is that of the coarsest net.

    Raises
    ------
    NoSteadyState
        If no candidate balances the boards at the wanted angles.
    GearError
        For a gear without boards.
    """
    import cma

    model.gear.require_boards('whose fastening points could be found')
    coarse = coarsest_model(model)
    limits = CommandLimits(warps=warp_lengths, speeds=speeds)
    middle = math.sqrt(math.prod(warp_lengths)), math.sqrt(math.prod(speeds))
    places = (*product(warp_lengths, speeds), middle)
    wish = _Wish(attack, inclination, pitch, middle, places, limits, options)
    search = cma.CMAEvolutionStrategy(
        coarse.board.points.ravel(),
        options.first_step_m,
        {'seed': options.search_seed, 'popsize': options.per_generation, 'verbose': -9},
    )
    first = _lean(coarse, wish)
    best = _judged(coarse, wish, coarse.board.points.ravel())
    judge = partial(_judged, coarse, wish)
    for done in range(0, options.candidates, options.per_generation):
        on_progress(WorkProgress('riggings', done, options.candidates))
        tried = search.ask()
        tasks = {f'rigging {number}': one for number, one in enumerate(tried)}
        found = dict(run_tasks(judge, tasks))
        search.tell(tried, [found[name][0] for name in tasks])
        best = min((best, *found.values()), key=lambda one: one[0])
    on_progress(WorkProgress('riggings', options.candidates, options.candidates))
    _, lean, points = best
    if points is None:
        raise NoSteadyState(
            'no fastening points were found that balance the boards at the wanted angles'
        )
    return MotionTrim(points, float(np.radians(lean)), float(np.radians(first)))


Judged = tuple[float, float, FloatArray | None]
"""Merit of a candidate (deg), its lean (deg), and its trimmed points; None if it has none."""


def _judged(model: GearModel, wish: _Wish, coordinates: FloatArray) -> Judged:
    """Trim a candidate, tow it, and return its merit, of which less is better."""
    options, limits = wish.options, hole_limits(model.board)
    points, beyond = coordinates.reshape(3, 3), np.inf
    try:
        # A trim knows no limits: alternate between the wanted angles and the room for holes.
        for _ in range(options.projections):
            points = _trimmed(model, wish, np.clip(points, -limits, limits))
            beyond = float(np.maximum(np.abs(points) - limits, 0.0).sum())
            if beyond < BOUND_TOLERANCE_M:
                break
        else:
            return (
                2.0 * FALLEN_LEAN_DEG + options.beyond_limits_deg_m * beyond,
                FALLEN_LEAN_DEG,
                None,
            )
    except NoSteadyState:
        return 4.0 * FALLEN_LEAN_DEG, FALLEN_LEAN_DEG, None
    points = np.clip(points, -limits, limits)
    model = model.with_board(points=points)
    unknown = model.with_coefficients(np.array(model.gear.identification.start))
    attacks = [_attack(board, place) for board in (model, unknown) for place in wish.places]
    away = [math.degrees(abs(one - wish.attack)) for one in attacks if one is not None]
    lean = _lean(model, wish)
    merit = (
        lean
        + options.attack_weight * sum(away) / max(len(away), 1)
        + options.unusable_deg * (1.0 - len(away) / len(attacks))
    )
    return merit, lean, points


def _trimmed(model: GearModel, wish: _Wish, points: FloatArray) -> FloatArray:
    """Return the points nearest to these that give the wanted angles in the middle place."""
    warp, speed = wish.middle
    return trim(
        model.with_board(points=points),
        attack=wish.attack,
        inclination=wish.inclination,
        pitch=wish.pitch,
        warp_length=warp,
        speed=speed,
    ).points


def _attack(model: GearModel, place: tuple[float, float]) -> float | None:
    """Return the attack (rad) of the port board at a place, or None where it is not usable."""
    try:
        return float(steady_state(model, *place).observables.port_attack)
    except NoSteadyState:
        return None


def _lean(model: GearModel, wish: _Wish) -> float:
    """Return the root mean square of the largest leans (deg) of all parts of the tows."""
    options = wish.options
    parts = [
        lean
        for seed in options.calm_seeds
        for lean in _leans(model, wish, seed, options.calm_s, swell=False)
    ]
    parts += _leans(model, wish, options.swell_seed, options.swell_s, swell=True)
    return float(np.sqrt(np.mean(np.square(parts))))


def _leans(
    model: GearModel, wish: _Wish, seed: int, duration: float, *, swell: bool
) -> list[float]:
    """Return the largest lean (deg) of each part of a tow under random commands."""
    options, draws = wish.options, np.random.default_rng(seed)
    sea, period = CALM, CALM_PERIOD_S
    if swell:
        heave = partial(irregular_heave, options.swell_height_m, options.swell_period_s)
        sea, period = Sea(heave=heave(draws, begin=10.0, growth=20.0)), SWELL_PERIOD_S
    commands = RandomCommands(draws, wish.limits)
    warp, speed = wish.middle
    parts = np.zeros(math.ceil(duration / options.part_s))
    try:
        simulation = Simulation(model, Command(warp, warp, speed), period=period, sea=sea)
        for glance in range(round(duration / GLANCE_S)):
            time = glance * GLANCE_S
            simulation.command = commands.after(simulation.command, time)
            for _ in range(round(GLANCE_S / period)):
                now = simulation.advance()
            upward = np.real(now.motion.state.board_rotations[:, 2, 2]).min()
            lean = min(math.degrees(math.acos(np.clip(upward, -1.0, 1.0))), FALLEN_LEAN_DEG)
            part = int(time // options.part_s)
            parts[part] = max(parts[part], lean)
    except (NoSteadyState, StepFailed):
        parts[parts == 0.0] = FALLEN_LEAN_DEG
    return parts.tolist()
