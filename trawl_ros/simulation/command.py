"""Command to ship and winches."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Command:
    """Command to ship and winches: warp lengths (m), speed through the water (m/s),
    rate of turn (rad/s, to port positive).
    """

    port_length: float
    starboard_length: float
    speed: float
    turn_rate: float = 0.0
