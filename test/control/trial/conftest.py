"""A ship at sea for the trial alone: she does what is commanded, and her instruments say so."""

import math
from dataclasses import dataclass, field

import numpy as np
import pytest

from trawl_ros.control.trial.machine import Trial
from trawl_ros.control.trial.records import Knowledge, Proposal, TrialCommand, TrialTarget
from trawl_ros.core.time import SECOND
from trawl_ros.records.samples import (
    HeadingSample,
    PressureSample,
    RangeSample,
    VelocitySample,
    WinchSample,
)

STEP_S = 0.5
SURFACE = 101_325.0
PER_METRE = 10_052.0


def depth(pressure: float) -> float:
    """Depth for a pressure, near enough."""
    return (pressure - SURFACE) / PER_METRE


@dataclass
class Ship:
    """Ship with winches that obey at once; ``silent`` are instruments that say nothing."""

    trial: Trial
    now: float = 1000.0
    lengths: tuple[float, float] = (300.0, 300.0)
    speed: float = 2.1
    tension: float = 150e3
    seabed: float = 1000.0
    obeys: bool = True
    lost: tuple[str, ...] = ()
    silent: set[str] = field(default_factory=set)
    commands: list[tuple[float, TrialCommand | None]] = field(default_factory=list)

    def samples(self):
        stamp = round(self.now * SECOND)
        # Readings are never the very same twice.
        wobble = math.sin(self.now)
        yield (
            'winch',
            WinchSample(
                stamp, self.lengths, (0.0, 0.0), (self.tension + wobble, self.tension - wobble)
            ),
        )
        if self.now % 1.0:
            return
        log = np.array([self.speed + 1e-3 * wobble, 0.0, 0.0])
        yield 'log', VelocitySample(stamp, 'water', log, 0.0)
        yield 'compass', HeadingSample(stamp, 0.0, 0.002)
        for place, part in (('port', 0.3), ('starboard', 0.3), ('sonar', 0.35)):
            pressure = SURFACE + PER_METRE * part * self.lengths[0]
            yield place, PressureSample(stamp, place, pressure, 2e3)
        yield 'sounder', RangeSample(stamp, 'depth', self.seabed, 0.1, 1.0, 3000.0)

    def sail(self, seconds: float) -> None:
        """Go on for a while; the trial is asked twice a second."""
        for _ in range(round(seconds / STEP_S)):
            self.now += STEP_S
            now = round(self.now * SECOND)
            for name, sample in self.samples():
                if name not in self.silent:
                    self.trial.take(sample, now)
            command = self.trial.update(now, self.lost)
            self.commands.append((self.now, command))
            if command is not None and self.obeys:
                self.lengths, self.speed = (command.port, command.starboard), command.speed

    def windows(self, number: int, lengths=(400.0, 500.0, 600.0), *, advised=None, **known) -> None:
        """Let the estimator have so many windows, and propose these lengths."""
        targets = [TrialTarget(port=length, starboard=length, speed=2.1) for length in lengths]
        proposals = tuple(
            Proposal(target, 15.0, 1.0, 1.0, 150e3, 0.35 * target.port) for target in targets
        )
        self.trial.learn(
            Knowledge(number, {}, number if advised is None else advised, 1.0, proposals)
            if not known
            else Knowledge(windows=number, advised=number, proposals=proposals, **known)
        )

    @property
    def state(self):
        return self.trial.state()


@pytest.fixture
def sailing():
    """Make a ship under a trial of these settings."""

    def make(settings, memory=None, **ship) -> Ship:
        return Ship(Trial(settings, depth, memory), **ship)

    return make
