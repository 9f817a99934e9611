"""Errors of the depth sensors."""

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Readings, Situation

DOORS = ('port_door_depth', 'starboard_door_depth')
NET = 'net_depth'


class DepthSensor(Effect):
    """Offsets of doors and net, and scale and drift of all three depth sensors."""

    def apply_to_sensors(self, values: FloatArray, readings: Readings, at: Situation) -> Readings:
        """Readings with the errors of the depth sensors."""
        doors, net, scale, drift = values
        offsets = {**dict.fromkeys(DOORS, doors), NET: net}
        return readings | {
            name: (1.0 + scale) * readings[name] + offset + drift * at.hours
            for name, offset in offsets.items()
        }


EFFECT = DepthSensor(
    name='depth_sensor',
    sentence='Depth sensors show too much or too little, by metres, by a part, or more and more.',
    parameters=(
        Parameter('doors_offset', 'm', 0.0, -30.0, 30.0, 5.0),
        Parameter('net_offset', 'm', 0.0, -30.0, 30.0, 5.0),
        Parameter('scale', '', 0.0, -0.1, 0.1, 0.02),
        Parameter('drift', 'm per h', 0.0, -10.0, 10.0, 2.0),
    ),
    excited_by='depth, and time in the tow; a surfaced door shows the offset',
    confused_with=('gear_weight',),
    direct='Read the depth sensors with doors and sonar at the surface: what '
    'they show then is their offset.',
    causes='a sensor that has aged, mud in its port, air pressure not subtracted, another density '
    'of the water.',
)
