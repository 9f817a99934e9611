# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Random commands to ship and winches: a gear hauled, veered, slowed down and turned."""

from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.simulation.command import Command


@dataclass(frozen=True)
class CommandLimits:
    """Limits of random commands.

    Attributes
    ----------
    warps, speeds
        Shortest and longest warp (m), lowest and highest speed (m/s).
    speed_step
        Largest change of speed at once, m/s.
    turn_rate, turn
        Largest rate of turn (rad/s) and change of course by one command (rad): in a longer turn
        at that rate the gear comes to lie within the ship's circle, and its inner board falls.
    uneven
        Largest difference of the warps, as a part of their length.
    uneven_share, turning_share
        Shares of commands with uneven warps and with a turn.
    wait
        Shortest and longest time between two commands, s.
    """

    warps: tuple[float, float] = (150.0, 1000.0)
    speeds: tuple[float, float] = (1.5, 2.8)
    speed_step: float = 0.3
    turn_rate: float = np.radians(0.25)
    turn: float = np.radians(45.0)
    uneven: float = 0.03
    uneven_share: float = 0.3
    turning_share: float = 0.5
    wait: tuple[float, float] = (60.0, 600.0)


class RandomCommands:
    """Random commands in the order of time.

    Parameters
    ----------
    draws
        Generator of the commands.
    limits
        Limits within which they are drawn.

    Examples
    --------
    >>> import numpy as np
    >>> from trawl_ros import Command
    >>> from trawl_ros.simulation.random_commands import CommandLimits, RandomCommands
    >>> commands = RandomCommands(np.random.default_rng(1), CommandLimits())
    >>> drawn = commands.after(Command(500.0, 500.0, 2.1), 0.0)
    >>> 150.0 <= drawn.port_length <= 1000.0
    True
    """

    def __init__(self, draws: np.random.Generator, limits: CommandLimits) -> None:
        self._draws, self._limits = draws, limits
        self._following, self._straight = 0.0, np.inf

    def after(self, command: Command, time: float) -> Command:
        """Return the command at a time (s), given the one before, which may stay."""
        if time >= self._following:
            command = self._drawn(command.speed)
            self._following = time + self._draws.uniform(*self._limits.wait)
            rate = abs(command.turn_rate)
            self._straight = time + self._limits.turn / rate if rate else np.inf
        elif time >= self._straight:
            command, self._straight = replace(command, turn_rate=0.0), np.inf
        return command

    def _drawn(self, speed: float) -> Command:
        """Draw a command after one with a speed."""
        draws, limits = self._draws, self._limits
        port, uneven, rate = draws.uniform(*limits.warps), 0.0, 0.0
        if draws.random() < limits.uneven_share:
            uneven = draws.uniform(-limits.uneven, limits.uneven)
        if draws.random() < limits.turning_share:
            rate = draws.uniform(-limits.turn_rate, limits.turn_rate)
        step = draws.uniform(-limits.speed_step, limits.speed_step)
        speed = float(np.clip(speed + step, *limits.speeds))
        return Command(port, port * (1.0 + uneven), speed, float(rate))
