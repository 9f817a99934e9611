"""Design of the next tow that best discriminates an effect from its rivals."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.diagnosis.candidates import Candidate, signatures
from trawl_ros.diagnosis.evidence import Evidence, evidence
from trawl_ros.diagnosis.score_test import ScoreTest
from trawl_ros.estimation.fit.linearised import Linearised, linearise
from trawl_ros.estimation.windows.over_ground import GroundTrack
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.records.channels import CHANNELS
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.predict import Predictor

STATES = 3
"""Steady states of a tow that is proposed."""

STATE_MINUTES = 20.0
"""A state takes so long, with what the gear takes to settle."""

TOLD = 3
"""So many tows are proposed."""


@dataclass(frozen=True)
class Proposal:
    """Proposed tow of steady states (warp length m, speed m/s), on the same or reciprocal track.

    ``before`` and ``after`` are the χ² by which an effect is better than its nearest rival, with
    the tows at hand and with this one too.
    """

    states: tuple[tuple[float, float], ...]
    reciprocal: bool
    before: float
    after: float

    @property
    def hours(self) -> float:
        """Duration, h."""
        return len(self.states) * STATE_MINUTES / 60.0

    @property
    def per_hour(self) -> float:
        """Gain of χ² per hour."""
        return (self.after - self.before) / self.hours

    def __str__(self) -> str:
        lengths, speeds = zip(*self.states, strict=True)
        many = len(set(lengths)) > 1
        what = (
            f'warp lengths of {", ".join(f"{length:.0f}" for length in lengths)} m at '
            f'{speeds[0]:.1f} m/s'
            if many
            else f'speeds of {", ".join(f"{speed:.1f}" for speed in speeds)} m/s with '
            f'{lengths[0]:.0f} m of warp'
        )
        track = ', on the reciprocal track' if self.reciprocal else ''
        return (
            f'Tow {what}{track}: an hour of it parts the best effect from its nearest rival by '
            f'{self.per_hour:.1f} of χ² more (so far {self.before:.1f}).'
        )


def propose(
    predictor: Predictor,
    seen: ScoreTest,
    best: Candidate,
    values: FloatArray,
    rivals: Sequence[Candidate],
) -> tuple[Proposal, ...]:
    """Propose tows like those at hand, and those on the reciprocal track.

    Parameters
    ----------
    predictor
        The gear as it is believed.
    seen
        The first look.
    best, values
        The effect, and its values (m,) as they were found.
    rivals
        Effects from which it is to be told.

    Returns
    -------
    tuple
        The best few, the best first; none where no rival is given.
    """
    if not rivals:
        return ()
    now = evidence(seen.fit, seen.columns, seen.units)
    before = _apart(seen, now, best, values, rivals)
    known = dict(zip(_places(seen), seen.fit.windows, strict=True))
    solved: dict[tuple[float, float], Linearised] = {}
    another = 1 + max(part.window.tow for part in seen.fit.windows)
    found = []
    for states in _tows(seen):
        for reciprocal in (False, True):
            try:
                states_solved = [_solved(predictor, seen, known, solved, one) for one in states]
            except NoSteadyState:
                continue
            parts = [
                _window_of(part, another, number, reciprocal)
                for number, part in enumerate(states_solved)
            ]
            fit = replace(seen.fit, windows=(*seen.fit.windows, *parts))
            more = signatures(predictor, parts, seen.wanted)
            after = evidence(fit, [*seen.columns, *more], seen.units)
            apart = _apart(seen, after, best, values, rivals)
            found.append(Proposal(states, reciprocal, before, apart))
    ranked = sorted(found, key=lambda proposal: -proposal.per_hour)
    return tuple(proposal for proposal in ranked[:TOLD] if proposal.per_hour > 0.0)


def _apart(
    seen: ScoreTest,
    there: Evidence,
    best: Candidate,
    values: FloatArray,
    rivals: Sequence[Candidate],
) -> float:
    """Least χ² of an effect that a rival cannot explain."""
    block = list(seen.block(best))
    scaled = (values - best.start) / best.scale
    left = []
    for rival in rivals:
        rest = there.without(seen.block(rival)).information[np.ix_(block, block)]
        left.append(float(scaled @ rest @ scaled))
    return min(left)


def _places(seen: ScoreTest) -> list[tuple[float, float, int]]:
    return [
        (float(part.inputs[:2].mean()), float(part.inputs[2]), part.window.index)
        for part in seen.fit.windows
    ]


def _tows(seen: ScoreTest) -> list[tuple[tuple[float, float], ...]]:
    """Tows of speed steps at both ends of the warp's range, and warp steps at both speeds'."""
    lengths, speeds, _ = (np.array(column) for column in zip(*_places(seen), strict=True))
    steps = [np.linspace(values.min(), values.max(), STATES) for values in (lengths, speeds)]
    found = [tuple((float(end), float(u)) for u in steps[1]) for end in steps[0][[0, -1]]]
    found += [tuple((float(w), float(end)) for w in steps[0]) for end in steps[1][[0, -1]]]
    return found


def _solved(
    predictor: Predictor,
    seen: ScoreTest,
    known: dict[tuple[float, float, int], Linearised],
    solved: dict[tuple[float, float], Linearised],
    state: tuple[float, float],
) -> Linearised:
    """Linearised gear in a state that was not towed, as instruments would show it."""
    if state in solved:
        return solved[state]
    length, speed = state
    near = min(known, key=lambda at: abs(at[0] / length - 1.0) + abs(at[1] / speed - 1.0))
    part = known[near]
    noise = {
        name: float(np.median([w.window.noise[name] for w in known.values()
                               if name in w.window.noise]))
        for name in part.window.means
    }  # fmt: skip
    asked = {'port_length': length, 'starboard_length': length, 'speed': speed}
    window = replace(part.window, means={**part.window.means, **asked}, noise=noise)
    board = seen.fit.coefficients[seen.fit.prior.slice_of('coefficients')]
    found = linearise(predictor, OBSERVABLES, window, board, (part.state, None), even=False)
    means = {**window.means, **dict(zip(found.channels, map(float, found.values), strict=True))}
    bias = {name: CHANNELS[name].bias_std(mean) for name, mean in means.items()}
    window = replace(window, means=means, bias=bias, to_come={})
    solved[state] = replace(found, window=window, measured=np.array(found.values))
    return solved[state]


def _window_of(part: Linearised, tow: int, number: int, reciprocal: bool) -> Linearised:
    """Copy of a window as one of a tow of its own."""
    window: SteadyWindow = part.window
    heading = 0.0 if window.sense > 0.0 else math.pi
    if reciprocal:
        heading = math.pi - heading
    place = -1 - number
    window = replace(
        window,
        index=place,
        state=place,
        tow=tow,
        hours=number * STATE_MINUTES / 60.0,
        track=GroundTrack(heading, 0.0, 0.0, False),
    )
    return replace(part, window=window)
