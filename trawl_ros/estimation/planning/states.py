# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Candidate steady states of a trial, and the predictions in each.

A turn is not among them: a gear that is towed around has no steady state in fixed axes. Nor is an
opposite heading, which shows nothing new where there is no current.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState, TrawlError
from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
from trawl_ros.estimation.fit.linearised import Linearised, linearise
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.model.gear_model import GearModel
from trawl_ros.records.channels import CHANNELS, INPUTS, MEASURED
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.equilibrium import Equilibrium, require_usable
from trawl_ros.solver.predict import Predictor

PLANNED = tuple(name for name in MEASURED if name in OBSERVABLES and CHANNELS[name].usual)
"""Channels that a planned window is imagined to have: all usual ones that the model predicts."""

DEPTHS = tuple(name for name in PLANNED if name.endswith('depth'))
"""Of these, those that reach equilibrium last."""


@dataclass(frozen=True, order=True)
class Manoeuvre:
    """Manoeuvre: warp lengths (m) and speed through the water (m/s) of a steady state."""

    port_length: float
    starboard_length: float
    speed: float

    @property
    def length(self) -> float:
        """Length of the longer warp, m."""
        return max(self.port_length, self.starboard_length)

    @property
    def equal(self) -> bool:
        """True if both warps are equally long."""
        return self.port_length == self.starboard_length

    def distance(self, other: 'Manoeuvre') -> float:
        """Distance of another manoeuvre: the sum of its relative differences from this one."""
        return (
            abs(other.port_length / self.port_length - 1.0)
            + abs(other.starboard_length / self.starboard_length - 1.0)
            + abs(other.speed / self.speed - 1.0)
        )

    def __str__(self) -> str:
        lengths = f'{self.port_length:g}'
        if not self.equal:
            lengths += f'/{self.starboard_length:g}'
        return f'{lengths} m at {self.speed:g} m/s'


@dataclass(frozen=True)
class Limits:
    """Limits of the choice of manoeuvres.

    Attributes
    ----------
    lengths, speeds
        Warp lengths (m) and speeds (m/s), rising.
    shorter
        Metres by which the port warp may be shorter than the starboard one; the other way around
        shows the same.
    max_tension
        Highest tension (N) of a warp.
    seabed
        Depth of the water (m).
    clearance
        Least distance (m) of the gear from the seabed.
    """

    lengths: tuple[float, ...] = (200.0, 300.0, 400.0, 500.0, 700.0, 900.0)
    speeds: tuple[float, ...] = (1.9, 2.1, 2.3, 2.5)
    shorter: tuple[float, ...] = (5.0,)
    max_tension: float | None = None
    seabed: float | None = None
    clearance: float = 10.0


@dataclass(frozen=True)
class TowableManoeuvre:
    """Candidate: a feasible manoeuvre and the linearised model there.

    Known too are the decay time (s, to 1/e) of its slowest motion, and the depth (m) of the gear's
    deepest point.
    """

    manoeuvre: Manoeuvre
    part: Linearised
    decay: float
    deepest: float

    @property
    def tension(self) -> float:
        """Predicted tension of the tauter warp, N."""
        observables = self.part.state.observables
        return float(max(observables.port_tension, observables.starboard_tension))


@dataclass(frozen=True)
class Refused:
    """Refused manoeuvre with the reason."""

    manoeuvre: Manoeuvre
    reason: str


@dataclass(frozen=True)
class ManoeuvreChoice:
    """Choice: feasible and refused manoeuvres."""

    candidates: tuple[TowableManoeuvre, ...]
    refused: tuple[Refused, ...]

    def without(self, lost: Mapping[Manoeuvre, Refused]) -> 'ManoeuvreChoice':
        """Copy of the choice without manoeuvres found infeasible."""
        left = tuple(candidate for candidate in self.candidates if candidate.manoeuvre not in lost)
        return ManoeuvreChoice(left, (*self.refused, *lost.values()))


def deepest_point(model: GearModel, steady: Equilibrium) -> float:
    """Depth (m) of the gear's deepest node or door's edge."""
    state = steady.state
    half = 0.5 * model.board.span * np.abs(state.board_rotations[:, 2, 2])
    return -float(min(state.nodes[:, 2].min(), (state.board_positions[:, 2] - half).min()))


class Explorer:
    """Solver of manoeuvres one after the other, so that one may stop in between.

    Parameters
    ----------
    predictor
        The model of the gear.
    coefficients
        Of the board, (q,), as they are believed to be.
    limits
        Among which manoeuvres one may choose.
    """

    def __init__(
        self,
        predictor: Predictor,
        coefficients: FloatArray,
        limits: Limits | None = None,
    ) -> None:
        self.predictor = predictor
        self.coefficients = np.array(coefficients)
        self.limits = limits or Limits()

    def __len__(self) -> int:
        limits = self.limits
        return len(limits.lengths) * len(limits.speeds) * (1 + len(limits.shorter))

    @property
    def manoeuvres(self) -> tuple[Manoeuvre, ...]:
        """All manoeuvres: lengths rising, and at each from the highest speed down."""
        limits = self.limits
        return tuple(
            Manoeuvre(length - shorter, length, speed)
            for length in limits.lengths
            for shorter in (0.0, *limits.shorter)
            for speed in reversed(limits.speeds)
        )

    def __iter__(self) -> Iterator[TowableManoeuvre | Refused]:
        """Yield the solution of every manoeuvre once.

        At a length, nothing is sought at and below a speed at which a gear that could be towed
        faster cannot be towed any more: there the boards have lost their lift.
        """
        known: list[TowableManoeuvre] = []
        lost: dict[float, tuple[float, str]] = {}
        for manoeuvre in self.manoeuvres:
            slowest, reason = lost.get(manoeuvre.length, (0.0, ''))
            if manoeuvre.speed <= slowest:
                yield Refused(manoeuvre, reason)
                continue
            state = self.look_up(manoeuvre, known)
            if isinstance(state, TowableManoeuvre):
                known.append(state)
            elif any(faster(towable.manoeuvre, manoeuvre) for towable in known):
                lost[manoeuvre.length] = manoeuvre.speed, state.reason
            yield state

    def look_up(
        self, manoeuvre: Manoeuvre, known: Sequence[TowableManoeuvre]
    ) -> TowableManoeuvre | Refused:
        """Solve one manoeuvre, warm from those known, and check it."""

        def distance(other: TowableManoeuvre) -> float:
            return manoeuvre.distance(other.manoeuvre)

        starts = (min(known, key=distance).part.state, None) if known else (None,)
        try:
            asked = _asked(manoeuvre)
            linear = linearise(
                self.predictor, OBSERVABLES, asked, self.coefficients, starts, even=False
            )
            model = self.predictor.gear(self.coefficients, linear.inputs)
            steady = require_usable(model, linear.state)
        except NoSteadyState as reason:
            return Refused(manoeuvre, reason.reason)
        settling = steady.stability.settling_time
        deepest = deepest_point(model, linear.state)
        candidate = TowableManoeuvre(manoeuvre, linear, settling, deepest)
        trouble = self._trouble(candidate)
        return Refused(manoeuvre, trouble) if trouble else candidate

    def _trouble(self, candidate: TowableManoeuvre) -> str:
        limits = self.limits
        if limits.max_tension is not None and candidate.tension > limits.max_tension:
            return 'tension'
        if limits.seabed is not None and candidate.deepest + limits.clearance > limits.seabed:
            return 'seabed'
        return ''


def explore(explorer: Explorer, on_progress: OnProgress = ignore) -> ManoeuvreChoice:
    """Solve all manoeuvres.

    Parameters
    ----------
    explorer
        Iterator over them.
    on_progress
        Called after each of them.

    Raises
    ------
    TrawlError
        If the gear can be towed in none of them.
    """
    candidates, refused = [], []
    for done, state in enumerate(explorer, 1):
        if isinstance(state, TowableManoeuvre):
            candidates.append(state)
        else:
            refused.append(state)
        stage = 'steady states of the board as believed'
        on_progress(WorkProgress(stage, done, len(explorer)))
    if not candidates:
        reasons = ', '.join(sorted({refusal.reason for refusal in refused}))
        limits = explorer.limits
        raise TrawlError(
            f'the gear can be towed in none of {len(explorer)} manoeuvres, '
            f'{limits.lengths[0]:g} to {limits.lengths[-1]:g} m of warp at {limits.speeds[0]:g} to '
            f'{limits.speeds[-1]:g} m/s (found: {reasons}); expected one at least'
        )
    return ManoeuvreChoice(tuple(candidates), tuple(refused))


def faster(first: Manoeuvre, second: Manoeuvre) -> bool:
    """True if one is the other at a higher speed."""
    return first.speed > second.speed and replace(first, speed=second.speed) == second


def _asked(manoeuvre: Manoeuvre) -> SteadyWindow:
    """Window that asks the model for all planned channels."""
    inputs = (manoeuvre.port_length, manoeuvre.starboard_length, manoeuvre.speed)
    means = dict.fromkeys(PLANNED, 0.0) | dict(zip(INPUTS, inputs, strict=True))
    nothing = dict.fromkeys(means, 0.0)
    return SteadyWindow(0, 0, 0, 0, means, nothing, nothing, dict.fromkeys(means, 1))
