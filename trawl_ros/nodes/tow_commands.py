"""Checks of commands to `sim_node` against the limits of ship and winches."""

import math
from typing import Any

from trawl_ros.core.errors import MessageError
from trawl_ros.messages.commands import (
    VESSEL_COMMAND,
    WINCH_COMMAND,
    read_vessel_command,
    read_winch_command,
)

LENGTHS = (1.0, 3000.0)
"""Warp lengths, m."""

SPEEDS = (0.5, 4.0)
"""Speeds through the water, m/s."""

FASTEST_TURN = math.radians(3.0)


def wanted_lengths(message: Any) -> tuple[float | None, float | None]:
    """Return the warp lengths (m) of a command, None for a winch it does not name.

    Raises
    ------
    MessageError
        If it cannot be read, or asks for what cannot be.
    """
    wanted = read_winch_command(message)
    low, high = LENGTHS
    for length in wanted:
        if length is not None and not low <= length <= high:
            raise MessageError(
                f'{WINCH_COMMAND}: a warp length of {length:g} m; expected {low:g} to {high:g}'
            )
    return wanted


def wanted_motion(message: Any) -> tuple[float, float]:
    """Return the speed (m/s) and rate of turn (rad/s, to port) of a command.

    Raises
    ------
    MessageError
        If it cannot be read, or asks for what cannot be.
    """
    speed, turn = read_vessel_command(message)
    low, high = SPEEDS
    if not low <= speed <= high:
        raise MessageError(
            f'{VESSEL_COMMAND}: a speed of {speed:g} m/s; expected {low:g} to {high:g}'
        )
    if abs(turn) > FASTEST_TURN + 1e-12:
        raise MessageError(
            f'{VESSEL_COMMAND}: a rate of turn of {turn:g} rad/s; expected at most '
            f'{FASTEST_TURN:.4f} to either side'
        )
    return speed, turn
