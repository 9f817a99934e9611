# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""State machine of an autonomous trial: time and readings in, commands and reasons out."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from trawl_ros.control.autopilot import Autopilot, AutopilotSettings, HoldHeading
from trawl_ros.control.trial.choice import choose, waiting_for_advice
from trawl_ros.control.trial.memory import TrialMemory
from trawl_ros.control.trial.records import (
    Knowledge,
    TrialCommand,
    TrialSettings,
    TrialState,
    TrialTarget,
)
from trawl_ros.control.trial.watch import TrialWatch
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.geodesy import Datum
from trawl_ros.core.time import SECOND
from trawl_ros.records.samples import HeadingSample, Sample

MAX_STEP_S = 2.0
"""Longest time step of the commands, also after a longer gap."""

MAX_TIME_RATIO = 1.5
"""A state without enough windows is left after its expected time multiplied by this."""

FIRST_STATE_MINUTES = 30.0
"""Expected time of the first state, which has no proposal."""

RETREAT_AFTER_S = 60.0
"""Time at a limit after which the trial returns to the previous state."""

MIN_PAY_OUT_M_S = 0.05
"""Pay-out speed when the ship is at her least speed."""


@dataclass(frozen=True)
class Wanted:
    """Wanted warp lengths (m) and speed (m/s) at one instant."""

    port: float
    starboard: float
    speed: float


class Transit:
    """Transit: wanted lengths and speed on the way to a target.

    Warp is paid out only so fast that the gear keeps its least speed through the water; the ship
    speeds up first. Warp is hauled at the winches' speed.

    Parameters
    ----------
    settings
        Rates and the range of speeds.
    here
        Present state of ship and winches.
    """

    def __init__(self, settings: TrialSettings, here: TrialTarget) -> None:
        self.settings = settings
        self.wanted = Wanted(here.port, here.starboard, here.speed)
        self.target = here

    @property
    def arrived(self) -> bool:
        """True if the wanted state is the target."""
        wanted, target = self.wanted, self.target
        return (wanted.port, wanted.starboard, wanted.speed) == (
            target.port,
            target.starboard,
            target.speed,
        )

    def advance(self, dt: float, haul_share: float = 1.0) -> None:
        """Advance by ``dt`` seconds; ``haul_share`` of the winches' speed is used to haul."""
        settings, now, target = self.settings, self.wanted, self.target
        left = (target.port - now.port, target.starboard - now.starboard)
        speed = target.speed
        if max(left) > 0.0:
            veering = min(settings.least_speed + settings.winch_speed, settings.most_speed)
            speed = max(speed, veering)
        most = settings.ship_acceleration * dt
        faster = now.speed + min(max(speed - now.speed, -most), most)
        out = min(max(now.speed - settings.least_speed, MIN_PAY_OUT_M_S), settings.winch_speed) * dt
        haul = settings.winch_speed * haul_share * dt
        self.wanted = Wanted(
            _towards(now.port, target.port, out, haul),
            _towards(now.starboard, target.starboard, out, haul),
            faster,
        )


class Trial:
    """Autonomous trial.

    The caller passes samples (`take`) and the state of the estimator (`learn`), requests the
    command (`update`) several times a second, and saves `memory` when it changes.

    Parameters
    ----------
    settings
        Limits, rates and the goal.
    pressure_to_depth
        Function that converts an absolute pressure (Pa) to a depth (m).
    memory
        Memory of a trial to continue; by default a new trial begins.
    """

    def __init__(
        self,
        settings: TrialSettings,
        pressure_to_depth: Callable[[float], float],
        memory: TrialMemory | None = None,
    ) -> None:
        self.settings = settings
        self.memory = memory or TrialMemory()
        self.watch = TrialWatch(settings, pressure_to_depth)
        self._knowledge = Knowledge()
        self._transit: Transit | None = None
        self._pilot = Autopilot(AutopilotSettings(max_turn=settings.max_turn), Datum(0.0, 0.0))
        self._now: int | None = None
        self._held: tuple[str, ...] = ()
        self._at_limit_s = 0.0
        self._retreat_from: tuple[str, ...] = ()
        self._waits = 'for readings'

    def take(self, sample: Sample, now: int) -> None:
        """Take a sample that arrived at a time (ns)."""
        self.watch.take(sample, now)
        if isinstance(sample, HeadingSample):
            self._pilot.take(sample)

    def learn(self, knowledge: Knowledge) -> None:
        """Take the present knowledge of the estimator."""
        self._knowledge = knowledge.after(self._knowledge)

    def change(self, settings: TrialSettings) -> None:
        """Change the settings from the next update on."""
        self.settings = self.watch.settings = settings
        self._pilot.settings = AutopilotSettings(max_turn=settings.max_turn)
        if self._transit is not None:
            self._transit.settings = settings

    def pause(self) -> str:
        """Hold ship and winches until `resume`."""
        self._require_running()
        self._keep(mode='paused')
        return 'the trial is paused; ship and winches hold'

    def resume(self) -> str:
        """Continue after `pause` or `take_over`, from the state of ship and winches then."""
        if self.memory.mode == 'sails':
            raise TrawlError('the trial is running; expected a paused or taken-over trial')
        self._keep(mode='sails')
        self._transit, self._waits = None, ''
        return 'the trial continues'

    def take_over(self, why: str = 'an operator has the command') -> str:
        """Stop sending commands until `resume`."""
        self._require_running()
        self._keep(mode='taken over')
        self._waits = why
        return f'the trial sends no commands: {why}'

    def veto(self) -> str:
        """Strike off the present target and choose another one."""
        self._require_running()
        target = self.memory.target
        if self.memory.phase not in ('transit', 'tow') or target is None:
            raise TrawlError('nothing to veto: the trial has no target at present')
        self._strike_off()
        return f'{target} is struck off'

    def update(self, now: int, lost: Sequence[str] = ()) -> TrialCommand | None:
        """Return the command at a time (ns), or None to send none.

        ``lost`` names nodes that are silent. If time goes back to before the beginning, the trial
        starts again.
        """
        dt = self._time_since(now)
        if self.memory.phase == 'done' or not self._ready(now, lost) or self._due():
            return None
        at_limit = self.watch.limits(now)
        new_limits = tuple(limit for limit in at_limit if limit not in self._retreat_from)
        problems = (*self.watch.stale(now), *self.watch.not_following(self._here()))
        self._held = (*(f'{name} is lost' for name in lost), *problems, *new_limits)
        if self.memory.mode == 'taken over':
            return None
        if self.memory.mode == 'sails':
            self._at_limit_s = self._at_limit_s + dt if new_limits else 0.0
            if not self._held:
                self._sail(now, dt)
            elif self._at_limit_s > RETREAT_AFTER_S:
                self._retreat(at_limit)
        return self._command(now)

    def state(self) -> TrialState:
        """Return the report."""
        memory, knowledge = self.memory, self._knowledge
        return TrialState(
            phase=memory.phase,
            mode=memory.mode,
            held=self._held,
            waits=memory.reason or self._waits,
            target=memory.target,
            hours=self._hours(),
            known=knowledge.known(self.settings.wanted_share),
            windows=knowledge.windows,
            towed=len(memory.towed),
            struck=len(memory.struck),
        )

    def _keep(self, **changes: object) -> None:
        self.memory = self.memory.changed(**changes)

    def _require_running(self) -> None:
        if self.memory.phase == 'done':
            raise TrawlError(f'the trial is done: {self.memory.reason}')

    def _hours(self) -> float:
        if self._now is None or self.memory.began_s is None:
            return 0.0
        return (self._now / SECOND - self.memory.began_s) / 3600.0

    def _time_since(self, now: int) -> float:
        before, self._now = self._now, now
        if self._hours() * 3600.0 < -1.0:
            self.memory, self._transit = TrialMemory(), None
        return 0.0 if before is None else min(max((now - before) / SECOND, 0.0), MAX_STEP_S)

    def _ready(self, now: int, lost: Sequence[str]) -> bool:
        """Return True once all readings are there; take over ship and winches as they are."""
        if self._transit is not None:
            return True
        self._held = ()
        if missing := self.watch.missing():
            self._waits = f'for readings of {", ".join(missing)}'
            return False
        if stale := (*self.watch.stale(now), *(f'{name} is lost' for name in lost)):
            self._waits = f'because {"; ".join(stale)}'
            return False
        memory, here = self.memory, self.watch.here()
        self._transit = Transit(self.settings, here)
        if memory.began_s is None:
            self._keep(began_s=now / SECOND, target=here)
            self._arrive(now, FIRST_STATE_MINUTES)
        elif memory.target is not None and memory.phase in ('transit', 'tow'):
            self._transit.target = memory.target
            if not here.near(memory.target):
                self._keep(phase='transit')
        return True

    def _due(self) -> bool:
        """Return True if the trial has just ended."""
        settings = self.settings
        known = self._knowledge.known(settings.wanted_share)
        if known >= settings.wanted_known:
            self._end(f'{known} quantities are known to {100 * settings.wanted_share:g} %')
        elif self._hours() >= settings.hours:
            self._end('the time is up')
        return self.memory.phase == 'done'

    def _end(self, reason: str) -> None:
        self._held = ()
        self._keep(phase='done', reason=reason)

    def _sail(self, now: int, dt: float) -> None:
        assert self._transit is not None
        memory = self.memory
        if memory.phase == 'advice':
            self._choose(now)
            return
        self._transit.advance(dt, self.watch.haul_share())
        if memory.phase == 'transit' and self._transit.arrived:
            self._retreat_from = ()
            self._arrive(now, memory.minutes)
        elif memory.phase == 'tow':
            self._tow(now)

    def _arrive(self, now: int, minutes: float) -> None:
        self.memory = self.memory.arrived(now / SECOND, minutes, self._knowledge.windows)
        self._waits = f'for its windows (0 of {self.settings.windows})'

    def _tow(self, now: int) -> None:
        memory = self.memory
        windows = self._knowledge.windows - memory.windows_before
        if windows < 0:
            self._keep(windows_before=self._knowledge.windows)  # The estimator has started again.
            return
        self._waits = f'for its windows ({windows} of {self.settings.windows})'
        minutes = (now / SECOND - memory.arrived_s) / 60.0
        if windows < self.settings.windows and minutes < MAX_TIME_RATIO * memory.minutes:
            return
        self.memory, self._waits = memory.left(now / SECOND, windows), 'for advice'

    def _choose(self, now: int) -> None:
        assert self._transit is not None
        knowledge, settings, memory = self._knowledge, self.settings, self.memory
        waited = now / SECOND - memory.arrived_s
        if why := waiting_for_advice(knowledge, settings, waited):
            self._waits = why
            return
        choice = choose(
            knowledge.proposals,
            settings,
            here=self._here(),
            towed=memory.towed,
            struck=memory.struck,
            minutes_left=60.0 * (settings.hours - self._hours()),
            seabed=self.watch.water_depth(now),
        )
        if choice.proposal is not None:
            self._head_for(choice.proposal.target, choice.proposal.minutes)
        elif choice.late and knowledge.looked_up >= 1.0:
            self._end('the remaining time is too short for any manoeuvre')
        else:
            self._waits = str(choice)

    def _here(self) -> TrialTarget:
        assert self._transit is not None
        wanted = self._transit.wanted
        return TrialTarget(port=wanted.port, starboard=wanted.starboard, speed=wanted.speed)

    def _head_for(self, target: TrialTarget, minutes: float) -> None:
        assert self._transit is not None
        self._transit.target, self._at_limit_s, self._waits = target, 0.0, ''
        self.memory = self.memory.heading_for(target, minutes)

    def _strike_off(self) -> None:
        """Strike off the present target and hold until the next one is chosen."""
        if self._transit is not None:
            self._transit.target = self._here()
        now_s = self.memory.arrived_s if self._now is None else self._now / SECOND
        self.memory = self.memory.struck_off(now_s)

    def _retreat(self, limits: tuple[str, ...]) -> None:
        """Return from a limit to the previous state."""
        if (origin := self.memory.origin) is None:
            return
        self._strike_off()
        self._retreat_from = limits
        self._head_for(origin, FIRST_STATE_MINUTES)
        self._keep(origin=None)

    def _command(self, now: int) -> TrialCommand:
        here = self._here()
        return TrialCommand(here.port, here.starboard, here.speed, self._turn_rate(now))

    def _turn_rate(self, now: int) -> float:
        heading = self.memory.heading
        if heading is None:
            if math.isnan(heading := self.watch.value('heading')):
                return 0.0
            self._keep(heading=heading)
        self._pilot.steer(HoldHeading(heading))
        return self._pilot.turn_rate(now)


def _towards(length: float, target: float, out: float, haul: float) -> float:
    return length + min(max(target - length, -haul), out)
