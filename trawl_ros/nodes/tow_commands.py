"""Checks of commands to `sim_node` against the limits of ship and winches."""

from typing import Any

from trawl_ros.core.errors import MessageError
from trawl_ros.messages.commands import (
    VESSEL_COMMAND,
    WINCH_COMMAND,
    read_vessel_command,
    read_winch_command,
)
from trawl_ros.records.towing_limits import LIMITS


def wanted_lengths(message: Any) -> tuple[float | None, float | None]:
    """Return the warp lengths (m) of a command, None for a winch it does not name.

    Raises
    ------
    MessageError
        If it cannot be read, or asks for what cannot be.
    """
    wanted = read_winch_command(message)
    if objection := LIMITS.objection(wanted):
        raise MessageError(f'{WINCH_COMMAND}: {objection}')
    return wanted


def wanted_motion(message: Any) -> tuple[float, float]:
    """Return the speed (m/s) and rate of turn (rad/s, to port) of a command.

    Raises
    ------
    MessageError
        If it cannot be read, or asks for what cannot be.
    """
    speed, turn = read_vessel_command(message)
    if objection := LIMITS.objection((), speed, turn):
        raise MessageError(f'{VESSEL_COMMAND}: {objection}')
    return speed, turn
