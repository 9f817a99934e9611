"""Records of a trial: targets, proposals, settings, commands and the report."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

from trawl_ros.core.schema import Record

Phase = Literal['start', 'transit', 'tow', 'advice', 'done']
"""Phases: until readings are there; on the way to a target; towed steadily until its windows are
taken; steady until the next target is chosen; and at the end."""

Mode = Literal['sails', 'paused', 'taken over']
"""Modes: the trial has the command; it has it and is told to stay; an operator has it."""


class TrialTarget(Record):
    """Target of a trial: warp lengths (m) and speed through the water (m/s)."""

    port: float
    starboard: float
    speed: float

    def near(self, other: 'TrialTarget', metres: float = 2.0, speed: float = 0.05) -> bool:
        """True if another target is the same within these tolerances (m, m/s)."""
        return (
            abs(self.port - other.port) <= metres
            and abs(self.starboard - other.starboard) <= metres
            and abs(self.speed - other.speed) <= speed
        )

    def __str__(self) -> str:
        lengths = f'{self.port:.0f}'
        if round(self.port) != round(self.starboard):
            lengths += f'/{self.starboard:.0f}'
        return f'{lengths} m at {self.speed:.2f} m/s'


@dataclass(frozen=True)
class Proposal:
    """Proposal: a target, and what the estimator expects of it.

    ``minutes`` from now until its windows are taken, ``nats`` of information gained, ``rate`` by
    which proposals are ranked, predicted ``tension`` (N) of the tauter warp and depth (m) of the
    gear's ``deepest`` point.
    """

    target: TrialTarget
    minutes: float
    nats: float
    rate: float
    tension: float
    deepest: float


@dataclass(frozen=True)
class Knowledge:
    """Knowledge of the estimator.

    Attributes
    ----------
    windows
        Number that it has used.
    ratios
        Std of each quantity of the laws over its span, by name; empty while not known.
    advised
        Number of windows on which the proposals rest.
    looked_up
        Share of all manoeuvres among which was chosen.
    proposals
        Ranked, the best one first.
    trouble
        Error of the advice, '' for none.
    """

    windows: int = 0
    ratios: Mapping[str, float] = field(default_factory=dict)
    advised: int = 0
    looked_up: float = 0.0
    proposals: tuple[Proposal, ...] = ()
    trouble: str = ''

    def known(self, share: float) -> int:
        """Number of quantities whose std is below this share of their span."""
        return sum(ratio <= share for ratio in self.ratios.values())

    def after(self, before: 'Knowledge') -> 'Knowledge':
        """Return this knowledge, with the proposals from before where it has none of its own."""
        if self.proposals or not self.windows:
            return self
        return replace(
            self,
            ratios=self.ratios or before.ratios,
            advised=before.advised,
            looked_up=before.looked_up,
            proposals=before.proposals,
        )


@dataclass(frozen=True)
class TrialSettings:
    """Settings of a trial.

    Attributes
    ----------
    hours
        Time for the trial, h.
    wanted_share, wanted_known
        It ends when so many quantities of the laws have a std below this share of their span.
    max_tension, max_depth, seabed, clearance
        Limits: tension (N) of a warp, depth (m) of the gear, depth (m) of the water where no
        sounder says it, and least distance (m) of the gear from the seabed; infinite without.
    max_turn
        Fastest rate of turn, rad/s.
    winch_speed, ship_acceleration
        Rates at which commands change, m/s and m/s².
    least_speed, most_speed
        Range of towing speeds, m/s: while warp runs out, the gear is to be no slower than the
        lower one.
    windows
        Windows that are taken in each state.
    least_looked_up, advice_patience
        No target is chosen before the advice rests on all windows and so much of the manoeuvres is
        looked up, or so many seconds have gone by.
    stale
        Age (s) at which a reading is stale, where it usually comes more often.
    """

    hours: float = 6.0
    wanted_share: float = 0.2
    wanted_known: int = 12
    max_tension: float = math.inf
    max_depth: float = math.inf
    seabed: float = math.inf
    clearance: float = 10.0
    max_turn: float = math.radians(0.15)
    winch_speed: float = 0.4
    ship_acceleration: float = 0.02
    least_speed: float = 1.9
    most_speed: float = 2.5
    windows: int = 2
    least_looked_up: float = 0.3
    advice_patience: float = 600.0
    stale: float = 1.5


@dataclass(frozen=True)
class TrialCommand:
    """Command of a trial: warp lengths (m), speed (m/s), rate of turn (rad/s, to port)."""

    port: float
    starboard: float
    speed: float
    turn_rate: float


@dataclass(frozen=True)
class TrialState:
    """Report of a trial.

    ``phase`` and ``mode`` as in `Phase` and `Mode`; ``held`` are the reasons for which it holds,
    ``waits`` says for what it waits; ``known`` of the quantities asked for, ``hours`` since the
    beginning; ``towed`` counts states with windows, ``struck`` those struck off.
    """

    phase: Phase
    mode: Mode
    held: tuple[str, ...]
    waits: str
    target: TrialTarget | None
    hours: float
    known: int
    windows: int
    towed: int
    struck: int

    def __str__(self) -> str:
        if self.mode != 'sails':
            return self.mode + (f': {self.waits}' if self.waits else '')
        if self.held:
            return f'holds: {"; ".join(self.held)}'
        words = {
            'start': 'waits',
            'transit': f'on the way to {self.target}',
            'tow': f'tows {self.target}',
            'advice': 'waits',
            'done': 'done',
        }[self.phase]
        return f'{words}: {self.waits}' if self.waits else words
