"""Scale and offset of the tension cells."""

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Readings, Situation

CELLS = ('port_tension', 'starboard_tension')


class TensionCell(Effect):
    """Tension cells that show (1 + scale) times the tension, and an offset, on both sides."""

    def apply_to_sensors(self, values: FloatArray, readings: Readings, at: Situation) -> Readings:
        """Readings with the errors of the tension cells."""
        offset, scale = values
        return readings | {name: (1.0 + scale) * readings[name] + offset for name in CELLS}


EFFECT = TensionCell(
    name='tension_cell',
    sentence='The tension cells show too much or too little.',
    parameters=(
        Parameter('offset', 'N', 0.0, -20e3, 20e3, 3e3),
        Parameter('scale', '', 0.0, -0.3, 0.3, 0.04),
    ),
    excited_by='tension; a slack winch shows the offset',
    confused_with=('net_drag',),
    direct='Read the tension cells with slack warps: what they show then is their offset.',
    causes='a cell that has aged, a lead angle at the block other than when it was calibrated, '
    'friction of sheaves.',
)
