"""Command to ship and winches."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Command:
    """Command to ship and winches: warp lengths (m), speed through the water (m/s),
    rate of turn (rad/s, to port positive).

    Examples
    --------
    >>> import trawl_ros
    >>> trawl_ros.Command(port_length=500.0, starboard_length=495.0, speed=2.1).turn_rate
    0.0
    """

    port_length: float
    starboard_length: float
    speed: float
    turn_rate: float = 0.0
