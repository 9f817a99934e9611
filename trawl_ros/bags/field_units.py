"""Units of the fields of messages, for columns of tables."""

from collections.abc import Mapping

_JOINTS = {'position': 'm', 'velocity': 'm/s', 'effort': 'N'}
_TWIST = {'linear': 'm/s', 'angular': 'rad/s'}

_BY_TOPIC: Mapping[str, Mapping[str, str]] = {
    'truth/winch': _JOINTS,
    'winch/joint_states': _JOINTS,
    'command/winch': _JOINTS,
    'truth/door/port/angles': {'vector': 'rad'},
    'truth/door/starboard/angles': {'vector': 'rad'},
    'truth/net/opening': {'vector': 'm'},
}
"""Units by topic and path that the contract fixes where the type leaves them open."""

_BY_TYPE: Mapping[str, Mapping[str, str]] = {
    'geometry_msgs/msg/PointStamped': {'point': 'm'},
    'geometry_msgs/msg/PolygonStamped': {'polygon.points': 'm'},
    'geometry_msgs/msg/PoseArray': {'poses.position': 'm'},
    'geometry_msgs/msg/PoseStamped': {'pose.position': 'm'},
    'geometry_msgs/msg/TwistStamped': {f'twist.{part}': unit for part, unit in _TWIST.items()},
    'geometry_msgs/msg/WrenchStamped': {'wrench.force': 'N', 'wrench.torque': 'N m'},
    'nav_msgs/msg/Odometry': {
        'pose.pose.position': 'm',
        **{f'twist.twist.{part}': unit for part, unit in _TWIST.items()},
    },
    'sensor_msgs/msg/FluidPressure': {'fluid_pressure': 'Pa', 'variance': 'Pa^2'},
    'sensor_msgs/msg/Imu': {
        'orientation_covariance': 'rad^2',
        'angular_velocity': 'rad/s',
        'angular_velocity_covariance': 'rad^2/s^2',
        'linear_acceleration': 'm/s^2',
        'linear_acceleration_covariance': 'm^2/s^4',
    },
    'sensor_msgs/msg/LaserScan': {
        'angle_min': 'rad',
        'angle_max': 'rad',
        'angle_increment': 'rad',
        'time_increment': 's',
        'scan_time': 's',
        'range_min': 'm',
        'range_max': 'm',
        'ranges': 'm',
    },
    'sensor_msgs/msg/NavSatFix': {
        'latitude': 'deg',
        'longitude': 'deg',
        'altitude': 'm',
        'position_covariance': 'm^2',
    },
    'sensor_msgs/msg/Range': {
        'field_of_view': 'rad',
        'min_range': 'm',
        'max_range': 'm',
        'range': 'm',
        'variance': 'm^2',
    },
}


def field_unit(topic: str, type_name: str, path: str) -> str:
    """Give the unit of a field, '' where it has none or none is known.

    Parameters
    ----------
    topic
        Relative name, as in the contract.
    type_name
        E.g. ``sensor_msgs/msg/Range``.
    path
        Names down to the field, without element numbers: ``pose.pose.position.x``.
    """
    if path.endswith('_ns'):
        return 'ns'
    if path.endswith('_s'):
        return 's'
    known = {**_BY_TYPE.get(type_name, {}), **_BY_TOPIC.get(topic, {})}
    steps = path.split('.')
    for length in range(len(steps), 0, -1):
        if unit := known.get('.'.join(steps[:length])):
            return unit
    return ''
