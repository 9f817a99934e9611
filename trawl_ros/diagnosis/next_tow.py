# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Design of the next tow that best discriminates an effect from its rivals."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.diagnosis.inference.blocks import blocks_of
from trawl_ros.diagnosis.inference.candidates import signatures
from trawl_ros.diagnosis.inference.marginal import Marginal, marginal
from trawl_ros.diagnosis.inference.screen import Screen, Suspect, ready_for
from trawl_ros.estimation.fit.linearised import Linearised, linearise
from trawl_ros.estimation.windows.over_ground import GroundTrack
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.records.channels import CHANNELS
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.predict import Predictor

STATES_PER_TOW = 3
"""Number of steady states of a proposed tow."""

STATE_MINUTES = 20.0
"""Duration of a state, settling of the gear included."""

DECISIVE_CHI2 = 10.0
"""χ² by which one cause must be better than another to exclude it (odds of 150)."""

MIN_CHI2_PER_HOUR = 1.0
"""Tows that gain less χ² per hour are not proposed."""

MAX_PROPOSALS = 3
"""Largest number of proposed tows."""


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
        verb = 'separates' if self.per_hour >= DECISIVE_CHI2 else 'helps to separate'
        return (
            f'Tow {what}{track}: an hour of it {verb} the best effect from its nearest rival '
            f'(χ² {self.per_hour:.1f} more, where {DECISIVE_CHI2:g} are enough; so far '
            f'{self.before:.1f}).'
        )


def propose(
    predictor: Predictor,
    screen: Screen,
    best: Suspect,
    values: FloatArray,
    rivals: Sequence[Suspect],
) -> tuple[Proposal, ...]:
    """Propose tows like those at hand, and those on the reciprocal track.

    Parameters
    ----------
    predictor
        The gear as it is believed.
    screen
        All hypotheses to first order.
    best, values
        The cause, and its values (m,) as they were found.
    rivals
        Causes from which it is to be told.

    Returns
    -------
    tuple
        The best few, the best first; none where no rival is given.
    """
    if not rivals:
        return ()
    every = (best, *rivals)
    wanted = [suspect.candidate for suspect in every]
    ready = ready_for(predictor, [suspect.entry.effect for suspect in every])
    units = np.concatenate([candidate.scale for candidate in wanted])
    places = [place for suspect in every for place in suspect.block]
    columns = [own[:, places] * units for own in screen.columns]
    scaled = (values - best.candidate.start) / best.candidate.scale

    def apart(windows: Sequence[Linearised], more: Sequence[FloatArray]) -> float:
        fit = replace(screen.fit, windows=(*screen.fit.windows, *windows))
        both = [*columns, *(own * units for own in more)]
        return _apart(marginal(blocks_of(fit, both, errors=screen.errors)), scaled, rivals)

    before = apart((), ())
    known = dict(zip(_places(screen), screen.fit.windows, strict=True))
    solved: dict[tuple[float, float], Linearised] = {}
    another = 1 + max(linear.window.tow for linear in screen.fit.windows)
    proposals = []
    for states in _tows(screen):
        for reciprocal in (False, True):
            try:
                states_solved = [
                    _solved(predictor, screen, known, solved, state) for state in states
                ]
            except NoSteadyState:
                continue
            windows = [
                _window_of(linear, another, number, reciprocal)
                for number, linear in enumerate(states_solved)
            ]
            after = apart(windows, signatures(ready, windows, wanted))
            proposals.append(Proposal(states, reciprocal, before, after))
    ranked = sorted(proposals, key=lambda proposal: -proposal.per_hour)
    return tuple(
        proposal for proposal in ranked[:MAX_PROPOSALS] if proposal.per_hour > MIN_CHI2_PER_HOUR
    )


def _apart(found: Marginal, scaled: FloatArray, rivals: Sequence[Suspect]) -> float:
    """Least χ² of the first cause, of these values in std, that a rival cannot explain."""
    own, first, left = range(len(scaled)), len(scaled), []
    for rival in rivals:
        block = range(first, first + len(rival.block))
        rest = found.without(block).of(own).information
        left.append(float(scaled @ rest @ scaled))
        first = block.stop
    return min(left)


def _places(screen: Screen) -> list[tuple[float, float, int]]:
    return [
        (float(linear.inputs[:2].mean()), float(linear.inputs[2]), linear.window.index)
        for linear in screen.fit.windows
    ]


def _tows(screen: Screen) -> list[tuple[tuple[float, float], ...]]:
    """Tows of speed steps at both ends of the warp's range, and warp steps at both speeds'."""
    lengths, speeds, _ = (np.array(column) for column in zip(*_places(screen), strict=True))
    steps = [
        np.linspace(values.min(), values.max(), STATES_PER_TOW) for values in (lengths, speeds)
    ]
    tows = [tuple((float(end), float(u)) for u in steps[1]) for end in steps[0][[0, -1]]]
    tows += [tuple((float(w), float(end)) for w in steps[0]) for end in steps[1][[0, -1]]]
    return tows


def _solved(
    predictor: Predictor,
    screen: Screen,
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
    board = screen.fit.coefficients[screen.fit.prior.slice_of('coefficients')]
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
