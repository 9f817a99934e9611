"""Attitude sensors of the doors that are mounted askew."""

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Readings, Situation

ANGLES = ('port_pitch', 'starboard_pitch', 'port_roll', 'starboard_roll')


class AttitudeMount(Effect):
    """Offsets of pitch and roll of either door."""

    def apply_to_sensors(self, values: FloatArray, readings: Readings, at: Situation) -> Readings:
        """Readings with the offsets."""
        return readings | {
            name: readings[name] + offset for name, offset in zip(ANGLES, values, strict=True)
        }


EFFECT = AttitudeMount(
    name='attitude_mount',
    sentence='Pitch or roll of a door is shown too large or too small: its sensor sits askew.',
    parameters=tuple(Parameter(name, 'rad', 0.0, -0.35, 0.35, 0.05) for name in ANGLES),
    excited_by='any tow',
    confused_with=('board_rigging',),
    direct='Hold the doors upright against the gallows and read pitch and roll.',
    causes='a sensor pocket that is bent, a sensor that has turned in its clamp or was put in '
    'after the zero was set.',
)
