"""Sensors of port and starboard that are swapped."""

from dataclasses import dataclass

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Readings, Situation


@dataclass(frozen=True)
class SwappedSides(Effect):
    """Exchange of the readings of either side: 0 is none, 1 all of it."""

    channels: tuple[str, ...] = ()

    def apply_to_sensors(self, values: FloatArray, readings: Readings, at: Situation) -> Readings:
        """Readings of one side with this share of the other's in place of their own."""
        shown = dict(readings)
        for channel in self.channels:
            port, starboard = f'port_{channel}', f'starboard_{channel}'
            more = values[0] * (readings[starboard] - readings[port])
            shown[port], shown[starboard] = readings[port] + more, readings[starboard] - more
        return shown


def _swapped(name: str, whose: str, channels: tuple[str, ...], direct: str) -> SwappedSides:
    return SwappedSides(
        name=name,
        sentence=f'{whose} of port and starboard are swapped (a share of 1).',
        # A share between is nothing real, but what noise and asymmetry make of one.
        parameters=(Parameter('share', '', 0.0, -0.3, 1.3, 0.5, whole=True),),
        excited_by='whatever differs between the sides: lean, unequal warps',
        direct=direct,
        causes='sensors hung on the wrong door, cables on the wrong plug, sides mistaken in the '
        'configuration.',
        channels=channels,
    )


EFFECTS = (
    _swapped(
        'swapped_doors',
        'Sensors of the doors',
        ('door_depth', 'pitch', 'roll'),
        "Tilt one door by hand and see which side's roll changes.",
    ),
    _swapped(
        'swapped_cells',
        'Tension cells',
        ('tension',),
        "Slacken one warp and see which side's tension falls.",
    ),
)
