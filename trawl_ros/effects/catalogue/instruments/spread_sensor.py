"""Scale and offset of the spread sensor."""

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Readings, Situation

SPREAD = 'door_spread'


class SpreadSensor(Effect):
    """Spread sensor that shows (1 + scale) times the spread, and an offset."""

    def apply_to_sensors(self, values: FloatArray, readings: Readings, at: Situation) -> Readings:
        """Readings with the error of the spread sensor."""
        scale, offset = values
        return readings | {SPREAD: (1.0 + scale) * readings[SPREAD] + offset}


EFFECT = SpreadSensor(
    name='spread_sensor',
    sentence='The spread between the doors is shown too large or too small.',
    parameters=(
        Parameter('scale', '', 0.0, -0.2, 0.2, 0.03),
        Parameter('offset', 'm', 0.0, -15.0, 15.0, 3.0),
    ),
    excited_by='spread: warp length and speed',
    confused_with=('net_drag',),
    direct='Hold the doors a measured distance apart at the stern and read their sensor.',
    causes='another speed of sound than set, sensors askew in their pockets, an echo from the '
    'bottom.',
)
