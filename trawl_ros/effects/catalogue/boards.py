# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Effects of the boards: their law, their rigging, their damage, their added mass."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Situation
from trawl_ros.model.hooks import DRAG, LIFT

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel

BOTH, PORT, STARBOARD = (0, 1), (0,), (1,)
"""Numbers of the boards that an effect acts on."""

STALL_ONSET_RAD = np.radians(15.0)
"""Angle of attack above which lift is lost, with the square of the excess."""


class BoardAddedMass(Effect):
    """Added mass across the board's face, as a share of the water in a cylinder around it."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Return the gear model with the boards' added mass."""
        board = model.board
        cylinder = 0.25 * np.pi * model.water.density * board.chord**2 * board.span
        return model.with_board(added_mass=board.added_mass + values[0] * cylinder * np.eye(3)[1])


@dataclass(frozen=True)
class DamageModifier:
    """Coefficient modifier: factors (2, 6) on the coefficients of port and starboard board."""

    factors: FloatArray

    def __call__(
        self, coefficients: FloatArray, attack: FloatArray, slip: FloatArray, lean: FloatArray
    ) -> FloatArray:
        """Multiply the coefficients."""
        # The zero gives the coefficients the shape and the kind (real or complex) of the angles.
        modified: FloatArray = (coefficients + 0.0 * attack[..., None]) * self.factors
        return modified


@dataclass(frozen=True)
class BoardDamage(Effect):
    """Change of lift and drag of the boards on ``sides``, as a share of their law."""

    sides: tuple[int, ...] = BOTH

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Return the gear model with boards of more or less lift and drag."""
        factors = np.ones((2, 6))
        factors[np.ix_(self.sides, (LIFT, DRAG))] += values
        return model.with_modifier(DamageModifier(factors))


@dataclass(frozen=True)
class BoardRigging(Effect):
    """Deviation from the installation angles of the boards on ``sides``."""

    sides: tuple[int, ...] = BOTH

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Return the gear model with other installation angles."""
        turned = np.array(model.board.rerigged)
        turned[list(self.sides)] += values
        port, starboard = (tuple(map(float, own)) for own in turned)
        return model.with_board(rerigged=(port, starboard))


@dataclass(frozen=True)
class StallModifier:
    """Coefficient modifier: lift below its straight line (eq. 14) at high attack."""

    loss: float

    def __call__(
        self, coefficients: FloatArray, attack: FloatArray, slip: FloatArray, lean: FloatArray
    ) -> FloatArray:
        """Subtract the loss from C_y^F; drag does not change."""
        above = np.where(np.real(attack) > STALL_ONSET_RAD, attack - STALL_ONSET_RAD, 0.0)
        modified = coefficients + 0.0 * attack[..., None]
        modified[..., LIFT] -= self.loss * above**2
        return modified


class BoardStall(Effect):
    """Less lift above 15° of attack."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Return the gear model with boards that stall."""
        return model.with_modifier(StallModifier(float(values[0])))


@dataclass(frozen=True)
class TiltModifier:
    """Coefficient modifier: lift that grows linearly as the outer face looks up."""

    slope: float

    def __call__(
        self, coefficients: FloatArray, attack: FloatArray, slip: FloatArray, lean: FloatArray
    ) -> FloatArray:
        """Multiply C_y^F by the factor of the tilt."""
        modified = coefficients + 0.0 * lean[..., None]
        modified[..., LIFT] = modified[..., LIFT] * (1.0 + self.slope * lean)
        return modified


class TiltLift(Effect):
    """Lift that depends on the boards' tilt."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Return the gear model with boards whose lift depends on their tilt."""
        return model.with_modifier(TiltModifier(float(values[0])))


def _damage(name: str, who: str, sides: tuple[int, ...]) -> BoardDamage:
    return BoardDamage(
        name=name,
        sentence=f'{who} more or less lift or drag than before: bent, torn or fouled.',
        parameters=(
            Parameter('lift', '', 0.0, -0.6, 0.6, 0.1),
            Parameter('drag', '', 0.0, -0.6, 1.0, 0.15),
        ),
        excited_by='any tow, compared with a baseline of the sound board',
        confused_with=('board_rigging', 'spread_sensor', 'net_drag'),
        direct='Look at the boards when they are up: bent or missing slats, dents, weed, a rope.',
        causes='a bent or missing slat, a dent, a fouled board, a board that was exchanged.',
        sides=sides,
    )


def _rigging(name: str, who: str, sides: tuple[int, ...]) -> BoardRigging:
    return BoardRigging(
        name=name,
        sentence=f'{who} at other angles in the rigging than the gear file says.',
        parameters=(
            Parameter('epsilon', 'rad', 0.0, -0.2, 0.2, 0.03),
            Parameter('zeta', 'rad', 0.0, -0.2, 0.2, 0.03),
            Parameter('eta', 'rad', 0.0, -0.2, 0.2, 0.03),
        ),
        excited_by='any tow, compared with a baseline of the earlier rigging',
        confused_with=('net_drag', 'spread_sensor', 'board_damage'),
        direct='Compare both boards with the rigging sheet: holes of warp and backstrops, lengths '
        'of the backstrops, wear of the shoes.',
        causes='a shackle in another hole of the warp bracket (ε), an upper or lower backstrop '
        'that was shortened or has stretched (ζ, η), a worn or a new shoe (η).',
        sides=sides,
    )


EFFECTS = (
    BoardAddedMass(
        name='board_added_mass',
        sentence='The boards carry water along when they are accelerated.',
        parameters=(Parameter('part', '', 0.0, 0.0, 2.0, 0.5),),
        excited_by='turns and hauling; no steady tow shows it',
        dynamic=True,
    ),
    _damage('board_damage', 'Both boards have', BOTH),
    _damage('port_board_damage', 'The port board has', PORT),
    _damage('starboard_board_damage', 'The starboard board has', STARBOARD),
    _rigging('board_rigging', 'Both boards hang', BOTH),
    _rigging('port_board_rigging', 'The port board hangs', PORT),
    _rigging('starboard_board_rigging', 'The starboard board hangs', STARBOARD),
    BoardStall(
        name='board_stall',
        sentence='The boards stall: above 15° of attack lift falls below its straight line.',
        parameters=(Parameter('loss', '1/rad²', 0.0, -4.0, 12.0, 2.0),),
        excited_by='high angles of attack: low speed, long warps',
        direct='Compare the angle of the boards with the rigging sheet, and look at their edges.',
        causes='boards set at a large attack, a worn or bent leading edge, too little weight in '
        'the shoes.',
    ),
    TiltLift(
        name='tilt_lift',
        sentence="The boards' lift changes as they lean inward or outward.",
        parameters=(Parameter('slope', '1/rad', 0.0, -2.0, 2.0, 0.5),),
        excited_by='what makes the boards lean: warp length and speed',
        confused_with=('warp_strumming',),
        direct='Compare the roll of both doors with the marks of wear on their shoes.',
        causes='boards that lean in or out with long or short warps, bridles of unequal length.',
    ),
)
