"""Design of the next tow that best discriminates an effect from its rivals."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.diagnosis.candidates import Candidate, signatures
from trawl_ros.diagnosis.evidence import Evidence, evidence
from trawl_ros.diagnosis.rules import LEAST_BIC
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

WORTH = 1.0
"""Tows of less χ² per hour are not proposed: no weather makes them tell."""

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
        tells = 'should tell' if self.per_hour >= LEAST_BIC else 'helps to tell'
        return (
            f'Tow {what}{track}: an hour of it {tells} the best effect from its nearest rival '
            f'(χ² {self.per_hour:.1f} more, where {LEAST_BIC:g} are enough; so far '
            f'{self.before:.1f}).'
        )


def propose(
    predictor: Predictor,
    test: ScoreTest,
    best: Candidate,
    values: FloatArray,
    rivals: Sequence[Candidate],
) -> tuple[Proposal, ...]:
    """Propose tows like those at hand, and those on the reciprocal track.

    Parameters
    ----------
    predictor
        The gear as it is believed.
    test
        The score test.
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
    now = evidence(test.fit, test.columns, test.units)
    before = _apart(test, now, best, values, rivals)
    known = dict(zip(_places(test), test.fit.windows, strict=True))
    solved: dict[tuple[float, float], Linearised] = {}
    another = 1 + max(linear.window.tow for linear in test.fit.windows)
    proposals = []
    for states in _tows(test):
        for reciprocal in (False, True):
            try:
                states_solved = [_solved(predictor, test, known, solved, state) for state in states]
            except NoSteadyState:
                continue
            windows = [
                _window_of(linear, another, number, reciprocal)
                for number, linear in enumerate(states_solved)
            ]
            fit = replace(test.fit, windows=(*test.fit.windows, *windows))
            more = signatures(predictor, windows, test.wanted)
            after = evidence(fit, [*test.columns, *more], test.units)
            apart = _apart(test, after, best, values, rivals)
            proposals.append(Proposal(states, reciprocal, before, apart))
    ranked = sorted(proposals, key=lambda proposal: -proposal.per_hour)
    return tuple(proposal for proposal in ranked[:TOLD] if proposal.per_hour > WORTH)


def _apart(
    test: ScoreTest,
    evidence_of_tow: Evidence,
    best: Candidate,
    values: FloatArray,
    rivals: Sequence[Candidate],
) -> float:
    """Least χ² of an effect that a rival cannot explain."""
    block = list(test.block(best))
    scaled = (values - best.start) / best.scale
    left = []
    for rival in rivals:
        rest = evidence_of_tow.without(test.block(rival)).information[np.ix_(block, block)]
        left.append(float(scaled @ rest @ scaled))
    return min(left)


def _places(test: ScoreTest) -> list[tuple[float, float, int]]:
    return [
        (float(linear.inputs[:2].mean()), float(linear.inputs[2]), linear.window.index)
        for linear in test.fit.windows
    ]


def _tows(test: ScoreTest) -> list[tuple[tuple[float, float], ...]]:
    """Tows of speed steps at both ends of the warp's range, and warp steps at both speeds'."""
    lengths, speeds, _ = (np.array(column) for column in zip(*_places(test), strict=True))
    steps = [np.linspace(values.min(), values.max(), STATES) for values in (lengths, speeds)]
    tows = [tuple((float(end), float(u)) for u in steps[1]) for end in steps[0][[0, -1]]]
    tows += [tuple((float(w), float(end)) for w in steps[0]) for end in steps[1][[0, -1]]]
    return tows


def _solved(
    predictor: Predictor,
    test: ScoreTest,
    known: dict[tuple[float, float, int], Linearised],
    solved: dict[tuple[float, float], Linearised],
    state: tuple[float, float],
) -> Linearised:
    """Linearised gear in a state that was not towed, as instruments would show it."""
    if state in solved:
        return solved[state]
    length, speed = state
    near = min(known, key=lambda at: abs(at[0] / length - 1.0) + abs(at[1] / speed - 1.0))
    nearest = known[near]
    noise = {
        name: float(np.median([w.window.noise[name] for w in known.values()
                               if name in w.window.noise]))
        for name in nearest.window.means
    }  # fmt: skip
    asked = {'port_length': length, 'starboard_length': length, 'speed': speed}
    window = replace(nearest.window, means={**nearest.window.means, **asked}, noise=noise)
    board = test.fit.coefficients[test.fit.prior.slice_of('coefficients')]
    linear = linearise(predictor, OBSERVABLES, window, board, (nearest.state, None), even=False)
    means = {**window.means, **dict(zip(linear.channels, map(float, linear.values), strict=True))}
    bias = {name: CHANNELS[name].bias_std(mean) for name, mean in means.items()}
    window = replace(window, means=means, bias=bias, to_come={})
    solved[state] = replace(linear, window=window, measured=np.array(linear.values))
    return solved[state]


def _window_of(linear: Linearised, tow: int, number: int, reciprocal: bool) -> Linearised:
    """Copy of a window as one of a tow of its own."""
    window: SteadyWindow = linear.window
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
    return replace(linear, window=window)
