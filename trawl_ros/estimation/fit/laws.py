# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The six laws of a board at its working angles: value and slope of each."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.model.board_laws import BoardLaw
from trawl_ros.model.numerics import STEP
from trawl_ros.records.observables import Observables

RANGE = np.radians(15.0)
"""Width (rad) of the working range, from 15 to 30° of attack; slip is given the same."""

DIFFERENCE = np.radians(0.1)
"""Width (rad) of the central differences of slopes."""

WELL_KNOWN = 0.2
"""Part of what its law spans below which the std of a quantity counts as well known."""


@dataclass(frozen=True)
class Law:
    """One of the six laws of a board: its quantity, its symbol, and the angle of its slope."""

    name: str
    symbol: str
    angle: Literal['attack', 'slip']


LAWS = (
    Law('drag', 'C_x^F', 'attack'),
    Law('lift', 'C_y^F', 'attack'),
    Law('force along the span', 'C_z^F', 'slip'),
    Law('roll moment', 'C_x^M', 'attack'),
    Law('pitch moment', 'C_y^M', 'slip'),
    Law('yaw moment', 'C_z^M', 'attack'),
)
"""In the order of eq. 36."""


@dataclass(frozen=True)
class WorkingAngles:
    """Mean attack and slip angle (rad) of the boards."""

    attack: float
    slip: float


@dataclass(frozen=True)
class LawQuantities:
    """Value and slope of each law, the values first, in the order of `LAWS`; no unit.

    Attributes
    ----------
    values : (12,) array
        The laws at the mean working angle, and by how much they change over 15° of it.
    sd : (12,) array
        Standard deviations of these.
    span : (12,) array
        Span of each quantity's law over 15°, without a sign.
    """

    values: FloatArray
    sd: FloatArray
    span: FloatArray

    @property
    def ratio(self) -> FloatArray:
        """Standard deviation over span (12,), infinite for a law without slope."""
        with np.errstate(divide='ignore'):
            return self.sd / self.span

    @property
    def well_known(self) -> BoolArray:
        """Flags (12,) of a standard deviation below a fifth of the span."""
        return self.ratio < WELL_KNOWN


QUANTITIES = tuple(f'{law.symbol} {what}' for what in ('value', 'slope') for law in LAWS)
"""Names of the twelve quantities, in order."""


def working_angles(observables: Iterable[Observables]) -> WorkingAngles:
    """Average the angles of both boards over steady states."""
    angles = np.array(
        [
            (
                observed.port_attack + observed.starboard_attack,
                observed.port_slip + observed.starboard_slip,
            )
            for observed in observables
        ]
    )
    attack, slip = 0.5 * angles.mean(axis=0)
    return WorkingAngles(float(attack), float(slip))


def law_values(law: BoardLaw, coefficients: FloatArray, angles: WorkingAngles) -> FloatArray:
    """Values (12,) of the twelve quantities of an upright board, whose coefficients are (q,)."""
    half = 0.5 * DIFFERENCE
    attack = angles.attack + half * np.array([0.0, 1.0, -1.0, 0.0, 0.0])
    slip = angles.slip + half * np.array([0.0, 0.0, 0.0, 1.0, -1.0])
    here, *sides = law(coefficients, attack, slip)
    by_attack, by_slip = sides[0] - sides[1], sides[2] - sides[3]
    change = np.where([own.angle == 'attack' for own in LAWS], by_attack, by_slip)
    return np.concatenate((here, RANGE / DIFFERENCE * change))


def law_rows(law: BoardLaw, coefficients: FloatArray, angles: WorkingAngles) -> FloatArray:
    """Derivatives (12, q) of the twelve quantities by the coefficients (q,)."""
    steps = coefficients + 1j * STEP * np.eye(len(coefficients))
    return np.stack([law_values(law, step, angles) for step in steps], axis=1).imag / STEP


def law_spans(
    law: BoardLaw,
    coefficients: FloatArray,
    angles: WorkingAngles,
    std: FloatArray | None = None,
) -> FloatArray:
    """Span (12,) of each quantity's law over 15° of its angle.

    Parameters
    ----------
    law, coefficients
        Of the board; (q,).
    angles
        Mean working angles of the boards.
    std
        Std (q,) of the coefficients: then the root mean square of what the laws may span, so
        that a law whose slope is not known yet has a span too.
    """
    variance = np.zeros(len(coefficients)) if std is None else std**2
    change = law_values(law, coefficients, angles)[len(LAWS) :]
    rows = law_rows(law, coefficients, angles)[len(LAWS) :]
    return np.tile(np.sqrt(change**2 + rows**2 @ variance), 2)


def law_quantities(
    law: BoardLaw,
    coefficients: FloatArray,
    covariance: FloatArray,
    angles: WorkingAngles,
    span: FloatArray | None = None,
) -> LawQuantities:
    """Value and slope of each law, and their std to first order.

    Parameters
    ----------
    law, coefficients, covariance
        Of the board; (q,) and (q, q).
    angles
        Mean working angles of the boards.
    span
        From `law_spans`, where it is not to be that of these coefficients.
    """
    rows = law_rows(law, coefficients, angles)
    return LawQuantities(
        values=law_values(law, coefficients, angles),
        sd=np.sqrt(np.einsum('ij,jk,ik->i', rows, covariance, rows)),
        span=law_spans(law, coefficients, angles) if span is None else span,
    )
