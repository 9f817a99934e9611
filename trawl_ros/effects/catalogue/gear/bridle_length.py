"""Length of the bridles beside the stated one."""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Situation
from trawl_ros.effects.catalogue.boards.board_rigging import BOTH, PORT, STARBOARD

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel

SIDES = ('port', 'starboard')


@dataclass(frozen=True)
class BridleLength(Effect):
    """Metres by which the bridles to upper and lower wing tips on ``sides`` are longer."""

    sides: tuple[int, ...] = BOTH

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Gear model with longer bridles; each of their bars by the same part."""
        longer = dict(zip(('upper', 'lower'), values, strict=True))
        names = {
            f'{SIDES[side]}_{own.name}_bridle': longer[own.at_net]
            for own in model.gear.bridles
            for side in self.sides
            if own.at_net in longer
        }
        rest = model.rest.copy()
        for name, _, bars in model.layout.lines:
            if name in names:
                rest[bars] *= 1.0 + names[name] / rest[bars].sum()
        return replace(model, rest=rest)


def _length(name: str, whose: str, sides: tuple[int, ...], std: float) -> BridleLength:
    return BridleLength(
        name=name,
        sentence=f'{whose} bridles are longer or shorter than the gear file has them.',
        parameters=(
            Parameter('upper', 'm', 0.0, -15.0, 15.0, std),
            Parameter('lower', 'm', 0.0, -15.0, 15.0, std),
        ),
        excited_by='any tow; upper against lower bridles by the opening',
        confused_with=('floats', 'gear_weight', 'board_rigging'),
        direct='Lay the bridles side by side on deck and measure them.',
        causes='a bridle that parted and was knotted or spliced, one that has stretched, a chain '
        'piece more or less, a wrong bridle after a change of nets.',
        sides=sides,
    )


EFFECTS = (
    _length('bridle_length', 'The', BOTH, 3.0),
    _length('port_bridle_length', 'The port', PORT, 1.5),
    _length('starboard_bridle_length', 'The starboard', STARBOARD, 1.5),
)
