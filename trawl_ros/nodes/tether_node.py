# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""`tether_node`: the gear behind a vehicle of any simulator."""

import math
from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from rosbags.typesys.stores import ros2_jazzy as ros

from trawl_ros.core.errors import MessageError, NoSteadyState
from trawl_ros.core.limits import TRUTH
from trawl_ros.core.rotations import rotation_matrix
from trawl_ros.core.time import SECOND
from trawl_ros.gear.load import load_gear
from trawl_ros.messages import pieces
from trawl_ros.messages.commands import WINCH_COMMAND, read_winch_command
from trawl_ros.messages.diagnostics import ERROR, OK, WARN, Status
from trawl_ros.messages.fields import beyond
from trawl_ros.messages.markers import gear_markers
from trawl_ros.messages.stamps import header, stamp_of
from trawl_ros.model.gear_model import build_model
from trawl_ros.nodes.command_watch import MAX_AGE, CommandWatch
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.parameters import Number, Text
from trawl_ros.nodes.runtime.qos import CONSUMER, STREAM
from trawl_ros.nodes.runtime.run import run
from trawl_ros.records.towing_limits import LIMITS
from trawl_ros.records.truth import SIDES
from trawl_ros.simulation.tether import Tether, VehicleMotion
from trawl_ros.solver.stepper import StepFailed

ODOMETRY, WRENCH, GEAR = 'tether/odom', 'tether/wrench', 'tether/gear'
FORCES = {side: f'tether/{side}/force' for side in SIDES}
MAX_GAP_S = 2.0
"""Longest time between two odometry messages (s) over which the gear is towed on."""

RETRY_M_S = 0.05
"""Change of speed (m/s) after which a steady state is sought again."""


class TetherNode(TrawlNode):
    """Tows a gear behind a vehicle whose odometry it hears, and publishes the forces on her.

    ``tether/odom`` has the pose in a frame with z up from the surface, and the twist in the
    vehicle's axes. ``tether/wrench`` acts on the vehicle's origin, in her axes.
    """

    SPECS: ClassVar = (
        Text('gear', 'kaifuha', 'Gear file, or the name of one that comes with the package.'),
        Number('warp_length_m', 500.0, 'm', *LIMITS.warp_m, 'Length of both warps at the start.'),
        Number('tow_point_x_m', 0.0, 'm', -500.0, 500.0,
               'Point midway between the blocks, ahead of the origin of the vehicle.'),
        Number('tow_point_z_m', 0.0, 'm', -100.0, 100.0, 'The same, above that origin.'),
        Number('step_s', 0.1, 's', 0.01, 0.2,
               'Least time between two steps of the gear; odometry between them is left out.'),
        Number('gear_rate_hz', 1.0, 'Hz', 0.0, 10.0, 'Rate of the markers on tether/gear.',
               live=True),
        Number('command_timeout_s', 0.0, 's', 0.0, 3600.0, 'Time of the odometry without a '
               'command/winch after which the winches stop; 0 is never.', live=True),
        MAX_AGE,
    )  # fmt: skip

    def __init__(self, **kwargs: Any) -> None:
        super().__init__('tether_node', **kwargs)
        self._model = build_model(load_gear(self.parameters['gear']))
        self._tether: Tether | None = None
        self._reached = 0
        self._drawn = -math.inf
        self._refused_at = math.nan
        self._problem = ''
        self._watch = CommandWatch(WINCH_COMMAND)
        self.advertise(WRENCH)
        self.advertise(GEAR)
        for topic in FORCES.values():
            self.advertise(topic)
        self.listen(WINCH_COMMAND, self._command, STREAM)
        self.listen(ODOMETRY, self._follow, CONSUMER)

    def statuses(self) -> list[Status]:
        """Return the status of the tow."""
        if self._problem:
            return [Status('tether', ERROR, self._problem)]
        if self._tether is None:
            return [Status('tether', WARN, self.with_namespace(f'waits for {ODOMETRY}'))]
        port, starboard = self._tether.lengths
        values = {'port warp': f'{port:.1f}', 'starboard warp': f'{starboard:.1f}'}
        if self._watch.lapsed:
            silence = f'{WINCH_COMMAND} silent for {self.parameters["command_timeout_s"]:g} s'
            return [Status('tether', WARN, f'{silence}: the winches stop', values)]
        return [Status('tether', OK, 'towing', values)]

    def _command(self, message: Any) -> None:
        wanted = read_winch_command(message)
        if objection := LIMITS.objection(wanted):
            raise MessageError(f'{WINCH_COMMAND}: {objection}')
        if self._tether is None:
            raise MessageError(f'{WINCH_COMMAND}: nothing is towed yet; expected {ODOMETRY} before')
        most_s = self.parameters['max_command_age_s']
        self._watch.take(stamp_of(message), self._reached, self._reached / SECOND, most_s)
        old = self._tether.wanted
        port, starboard = (before if new is None else new for before, new in zip(old, wanted))
        self._tether.wanted = port, starboard

    def _follow(self, message: Any) -> None:
        stamp, vehicle = stamp_of(message), _motion(message)
        span_s = (stamp - self._reached) / SECOND
        if self._tether is not None and 0.0 <= span_s < self.parameters['step_s'] - 1e-9:
            return
        if self._tether is None or not 0.0 < span_s <= MAX_GAP_S:
            self._begin(vehicle)
        else:
            self._go_on(vehicle, span_s)
        self._reached = stamp
        timeout_s = self.parameters['command_timeout_s']
        if self._tether is not None and self._watch.lapses(stamp / SECOND, timeout_s):
            self._tether.stop_winches()
        self.real_time_factor.reached(stamp)
        if self._tether is not None:
            self._publish(self._tether, stamp, message)

    def _begin(self, vehicle: VehicleMotion) -> None:
        speed = float(np.linalg.norm(vehicle.velocity))
        if abs(speed - self._refused_at) < RETRY_M_S:
            return
        length = self.parameters['warp_length_m']
        point = (self.parameters['tow_point_x_m'], 0.0, self.parameters['tow_point_z_m'])
        self._tether, self._drawn = None, -math.inf
        self._watch = CommandWatch(WINCH_COMMAND)
        try:
            self._tether = Tether(self._model, vehicle, (length, length), tow_point=point)
        except NoSteadyState as reason:
            self._refused_at = speed
            self._problem = f'{reason}; waits for another speed on {ODOMETRY}'
        else:
            self._problem, self._refused_at = '', math.nan

    def _go_on(self, vehicle: VehicleMotion, span_s: float) -> None:
        assert self._tether is not None
        try:
            self._tether.advance(vehicle, span_s)
        except StepFailed as reason:
            self._problem = (
                f'the motion of the gear cannot be computed ({reason}); expected odometry whose '
                'positions and velocities belong together'
            )
            self._tether = None

    def _publish(self, tether: Tether, stamp: int, odometry: Any) -> None:
        wrench, fixed = tether.wrench(), odometry.header.frame_id
        message = ros.geometry_msgs__msg__Wrench(
            pieces.vector(wrench.force), pieces.vector(wrench.moment)
        )
        own = header(stamp, odometry.child_frame_id)
        self.send(WRENCH, ros.geometry_msgs__msg__WrenchStamped(own, message))
        for topic, force in zip(FORCES.values(), tether.block_forces(), strict=True):
            vector = pieces.vector(force)
            self.send(topic, ros.geometry_msgs__msg__Vector3Stamped(header(stamp, fixed), vector))
        rate = self.parameters['gear_rate_hz']
        if rate and stamp / SECOND >= self._drawn + 1.0 / rate - 1e-9:
            self._drawn = stamp / SECOND
            if self.advertise(GEAR).get_subscription_count():
                self.send(GEAR, gear_markers(tether.picture(stamp), fixed)[1])


def _motion(message: Any) -> VehicleMotion:
    """Read an Odometry: its twist is in the frame of the vehicle."""
    if wrong := beyond(message, TRUTH.value):
        raise MessageError(f'{ODOMETRY}: {", ".join(sorted(wrong))} not finite or beyond {TRUTH}')
    pose, twist = message.pose.pose, message.twist.twist
    turn = rotation_matrix(pieces.read_orientation(ODOMETRY, pose.orientation))
    return VehicleMotion(
        position=pieces.read_vector(pose.position),
        rotation=turn,
        velocity=turn @ pieces.read_vector(twist.linear),
        rates=turn @ pieces.read_vector(twist.angular),
    )


def main(args: Sequence[str] | None = None) -> int:
    """Run the node."""
    return run(TetherNode, args)
