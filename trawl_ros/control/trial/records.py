# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Records of a trial: targets, proposals, settings, commands and the report."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

from trawl_ros.core.schema import Record

Phase = Literal['start', 'transit', 'tow', 'advice', 'done']
"""Phases: waiting for readings; on the way to a target; steady tow until its windows are taken;
steady tow until the next target is chosen; and end."""

Mode = Literal['sails', 'paused', 'taken over']
"""Modes: the trial has command; it has command and holds; an operator has command."""


class TrialTarget(Record):
    """Target of a trial: warp lengths (m) and speed through the water (m/s)."""

    port: float
    starboard: float
    speed: float

    def near(self, other: 'TrialTarget', metres: float = 2.0, speed: float = 0.05) -> bool:
        """Return True if another target is the same within these tolerances (m, m/s)."""
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

    ``minutes`` is the time until its windows are taken, ``nats`` the expected information, ``rate``
    the criterion of the ranking, ``tension`` (N) that of the tauter warp, and ``deepest`` (m) the
    depth of the gear's deepest point.
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
        Number of windows that it has used.
    ratios
        Std of each quantity of the laws relative to its span, by name; empty if unknown.
    advised
        Number of windows on which the proposals are based.
    looked_up
        Fraction of all manoeuvres that have been computed.
    proposals
        Ranked, the best one first.
    trouble
        Error of the advice, '' without one.
    """

    windows: int = 0
    ratios: Mapping[str, float] = field(default_factory=dict)
    advised: int = 0
    looked_up: float = 0.0
    proposals: tuple[Proposal, ...] = ()
    trouble: str = ''

    def known(self, share: float) -> int:
        """Return the number of quantities with a std below this fraction of their span."""
        return sum(ratio <= share for ratio in self.ratios.values())

    def after(self, before: 'Knowledge') -> 'Knowledge':
        """Return this knowledge, with the earlier proposals if it has none."""
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
        Duration of the trial, h.
    wanted_share, wanted_known
        The trial ends when this many quantities have a std below this fraction of their span.
    max_tension, max_depth, seabed, clearance
        Limits: tension (N) of a warp, depth (m) of the gear, depth (m) of the water without an
        echo sounder, and least distance (m) of the gear from the seabed; infinite for no limit.
    max_turn
        Fastest rate of turn, rad/s.
    winch_speed, ship_acceleration
        Rates at which commands change, m/s and m/s².
    least_speed, most_speed
        Range of towing speeds, m/s; while warp is paid out, the gear keeps at least the lower one.
    windows
        Number of windows in each state.
    least_looked_up, advice_patience
        A target is chosen only when the advice is based on all windows and on this fraction of the
        manoeuvres, or after this many seconds.
    stale
        Age (s) at which a reading is stale, if it usually comes more often.
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

    ``phase`` and ``mode`` are those of `Phase` and `Mode`. ``held`` are the reasons for holding,
    and ``waits`` is what the trial waits for. ``known`` counts the determined quantities, ``hours``
    the time since the beginning, ``towed`` the towed states and ``struck`` the struck-off targets.
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
