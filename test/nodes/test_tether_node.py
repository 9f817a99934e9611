"""`tether_node` tows behind a dummy vehicle, which feels its wrench, and says what fails."""

import numpy as np
import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from geometry_msgs.msg import WrenchStamped  # noqa: E402
from nav_msgs.msg import Odometry  # noqa: E402
from rclpy.node import Node  # noqa: E402

from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.messages.commands import winch_command  # noqa: E402
from trawl_ros.messages.diagnostics import ERROR  # noqa: E402
from trawl_ros.nodes.tether_node import TetherNode  # noqa: E402

pytestmark = pytest.mark.ros

STEP_S, MASS_KG = 0.1, 2e6
SPEED = 2.1


class Vehicle(Node):
    """Vehicle of another simulator: a mass on a straight course, whose thrust is the first pull."""

    def __init__(self, speed=SPEED, **kwargs):
        super().__init__('vehicle', namespace='trawl', **kwargs)
        self.place, self.speed, self.thrust, self.steps = 0.0, speed, None, 0
        self.wrenches = []
        self.sender = self.create_publisher(Odometry, 'tether/odom', 100)
        self.answered = False
        self.create_subscription(WrenchStamped, 'tether/wrench', self.take, 100)

    def take(self, wrench):
        self.wrenches.append(wrench)
        self.thrust = self.thrust or -wrench.wrench.force.x
        self.answered = True

    def tell(self):
        message = Odometry(child_frame_id='ship')
        message.header.frame_id = 'world'
        message.header.stamp.sec = self.steps // 10
        message.header.stamp.nanosec = self.steps % 10 * 100_000_000
        message.pose.pose.position.x = self.place
        message.pose.pose.orientation.w = 1.0
        message.twist.twist.linear.x = self.speed
        self.sender.publish(message)

    def move(self):
        """Go on by a step under thrust and wrench."""
        before = self.speed
        self.speed += (self.thrust + self.wrenches[-1].wrench.force.x) / MASS_KG * STEP_S
        self.place += 0.5 * (before + self.speed) * STEP_S
        self.steps += 1


@pytest.fixture
def tether(graph, gear_path):
    return graph.add(TetherNode, gear=str(gear_path), warp_length_m=300.0)


def towing(graph, vehicle, steps):
    """Exchange odometry and wrench, one for one."""
    graph.until(vehicle.sender.get_subscription_count)
    for _ in range(steps):
        vehicle.answered = False
        vehicle.tell()
        graph.until(lambda: vehicle.answered)
        vehicle.move()


def test_a_vehicle_whose_thrust_is_the_pull_keeps_her_speed(graph, tether):
    vehicle = graph.add(Vehicle)
    gear = graph.record('tether/gear', 'visualization_msgs/msg/MarkerArray')
    force = graph.record('tether/port/force', 'geometry_msgs/msg/Vector3Stamped')
    graph.rest(0.2)
    towing(graph, vehicle, 1)
    first = vehicle.wrenches[0]
    assert (first.header.frame_id, first.wrench.force.x < 0.0) == ('ship', True)
    towing(graph, vehicle, 50)
    assert vehicle.speed == pytest.approx(SPEED, abs=0.01)
    vehicle.thrust *= 1.5
    towing(graph, vehicle, 50)
    assert vehicle.speed > SPEED + 0.05
    assert -vehicle.wrenches[-1].wrench.force.x > -first.wrench.force.x
    graph.until(lambda: len(gear) > 5 and len(force) > 90)
    assert {'port_warp', 'door_port'} <= {marker.ns for marker in gear.latest.markers}
    assert force.latest.header.frame_id == 'world'
    assert {marker.header.frame_id for marker in gear.latest.markers} == {'world'}
    assert np.diff(gear.values(lambda message: message.markers[0].header.stamp.sec)).min() >= 1


def test_winches_obey(graph, tether):
    vehicle = graph.add(Vehicle)
    towing(graph, vehicle, 1)
    graph.command_winches(302.0, 300.0)
    graph.until(lambda: tether._tether.wanted == (302.0, 300.0))
    towing(graph, vehicle, 90)
    assert tether._tether.lengths == pytest.approx((302.0, 300.0), abs=0.05)


def test_winches_stop_when_nobody_commands_them_and_old_commands_are_refused(graph, gear_path):
    vehicle = graph.add(Vehicle)
    tether = graph.add(
        TetherNode, gear=str(gear_path), warp_length_m=300.0,
        command_timeout_s=2.0, max_command_age_s=1.0,
    )  # fmt: skip
    towing(graph, vehicle, 1)
    graph.send(*winch_command(50 * SECOND, 320.0, 320.0))
    graph.until(lambda: 'max_command_age_s' in graph.status('tether_node: messages').message)
    graph.send(*winch_command(0, 320.0, 320.0))
    graph.until(lambda: tether._tether.wanted == (320.0, 320.0))
    towing(graph, vehicle, 90)
    stopped = tether._tether.lengths
    assert stopped[0] == stopped[1] == pytest.approx(301.2, abs=0.8)
    graph.until(lambda: 'silent for 2 s' in graph.status('tether_node: tether').message)
    towing(graph, vehicle, 10)
    assert tether._tether.lengths == stopped


def test_a_speed_without_a_steady_state_is_said_and_another_one_helps(graph, tether):
    vehicle = graph.add(lambda **kwargs: Vehicle(speed=0.1, **kwargs))
    graph.until(vehicle.sender.get_subscription_count)
    vehicle.tell()
    graph.until(lambda: graph.status('tether_node: tether').level == ERROR)
    assert 'waits for another speed' in graph.status('tether_node: tether').message
    vehicle.speed, vehicle.steps = SPEED, 10
    towing(graph, vehicle, 2)


def test_a_pose_that_is_none_is_left_out(graph, tether):
    vehicle = graph.add(Vehicle)
    graph.until(vehicle.sender.get_subscription_count)
    vehicle.place = float('nan')
    vehicle.tell()
    graph.until(lambda: 'not finite' in graph.status('tether_node: messages').message)
    assert not vehicle.wrenches
