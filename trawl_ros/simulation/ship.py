# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Kinematics of ship and winches within their limits of speed and acceleration."""

import math
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.gear.records import ShipRecord, WinchRecord


def _approach(value: float, target: float, most: float) -> float:
    return value + min(max(target - value, -most), most)


@dataclass(frozen=True)
class Ship:
    """State of the ship.

    ``position`` is midway between the blocks (m), ``heading`` the ENU yaw (rad), ``speed`` that
    through the water (m/s), ``yaw_rate`` positive to port (rad/s), ``heave_rate`` positive up
    (m/s).
    """

    position: FloatArray
    heading: float
    speed: float
    yaw_rate: float
    heave_rate: float = 0.0

    @property
    def ahead(self) -> FloatArray:
        """Unit vector (3,) of the heading."""
        return np.array([math.cos(self.heading), math.sin(self.heading), 0.0])

    @property
    def velocity(self) -> FloatArray:
        """Velocity (3,) through the water in ``map`` axes, m/s."""
        velocity: FloatArray = self.speed * self.ahead + np.array([0.0, 0.0, self.heave_rate])
        return velocity

    def heaved(self, height: float, rate: float) -> 'Ship':
        """Return the ship at a ``height`` (m) above the mean surface, rising at ``rate`` (m/s)."""
        position = np.array([self.position[0], self.position[1], height])
        return replace(self, position=position, heave_rate=rate)

    def advanced(
        self, limits: ShipRecord, speed: float, yaw_rate: float, current: FloatArray, dt: float
    ) -> 'Ship':
        """Return the ship after ``dt`` s with a commanded speed and rate of turn in a current.

        Her height does not change; `heaved` sets it.
        """
        new_speed = _approach(self.speed, speed, limits.max_acceleration_m_s2 * dt)
        most = math.radians(limits.max_turn_acceleration_deg_s2) * dt
        new_rate = _approach(self.yaw_rate, yaw_rate, most)
        turned = self.heading + 0.5 * (self.yaw_rate + new_rate) * dt
        middle = 0.5 * (self.heading + turned)
        mean = 0.5 * (self.speed + new_speed)
        course = np.array([math.cos(middle), math.sin(middle), 0.0])
        return Ship(
            position=self.position + (mean * course + current) * dt,
            heading=turned,
            speed=new_speed,
            yaw_rate=new_rate,
            heave_rate=self.heave_rate,
        )


@dataclass(frozen=True)
class Winch:
    """Winch: warp length paid out (m) and pay-out speed (m/s)."""

    length: float
    speed: float

    def stop_length(self, limits: WinchRecord) -> float:
        """Return the length at which it stops soonest, m."""
        return self.length + self.speed * abs(self.speed) / (2.0 * limits.max_acceleration_m_s2)

    def advanced(
        self, limits: WinchRecord, length: float, dt: float, most_speed: float = math.inf
    ) -> 'Winch':
        """Return the winch after ``dt`` s of paying out or hauling towards a commanded length.

        It runs at no more than ``most_speed`` (m/s).
        """
        left = length - self.length
        most = limits.max_acceleration_m_s2
        if abs(left) <= most * dt**2 and abs(self.speed) <= most * dt:
            return Winch(length, 0.0)
        # Greatest speed from which the drum still stops in time after this step.
        side = math.copysign(1.0, left) if left else 0.0
        way = 2 * abs(left) - side * self.speed * dt
        root = math.sqrt((0.5 * most * dt) ** 2 + most * max(way, 0.0))
        wanted = side * min(limits.max_speed_m_s, most_speed, root - 0.5 * most * dt)
        speed = _approach(self.speed, wanted, most * dt)
        return Winch(self.length + 0.5 * (self.speed + speed) * dt, speed)
