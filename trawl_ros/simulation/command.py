# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Command to ship and winches."""

import math
from dataclasses import dataclass

from trawl_ros.core.errors import ScenarioError
from trawl_ros.records.towing_limits import LIMITS


@dataclass(frozen=True)
class Command:
    """Command to ship and winches.

    Warp lengths are in m, speed through the water in m/s, rate of turn in rad/s, positive to port.
    A winch runs at no more than its ``winch_speeds`` (port, starboard), m/s.

    Raises
    ------
    ScenarioError
        If a value is NaN or beyond the limits of a tow.

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
    winch_speeds: tuple[float, float] = (math.inf, math.inf)

    def __post_init__(self) -> None:
        lengths = self.port_length, self.starboard_length
        if objection := LIMITS.objection(lengths, self.speed, self.turn_rate):
            raise ScenarioError(objection)
