# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The six laws of eq. 14 at the working angles: value and slope of each."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.records.observables import Observables

RANGE = np.radians(15.0)
"""Width (rad) of the working range, from 15 to 30° of attack; slip is given the same."""

WELL_KNOWN = 0.2
"""Part of what its law spans below which the std of a quantity counts as well known."""


@dataclass(frozen=True)
class Law:
    """Linear law of eq. 14: its quantity, its symbol, coefficients and angle."""

    name: str
    symbol: str
    slope: str
    constant: str
    angle: Literal['attack', 'slip']

    @property
    def columns(self) -> list[int]:
        """Indices of slope and constant among the coefficients."""
        return [COEFFICIENTS.index(self.slope), COEFFICIENTS.index(self.constant)]


LAWS = (
    Law('drag', 'C_x^F', 'a1', 'c1', 'attack'),
    Law('lift', 'C_y^F', 'a2', 'c2', 'attack'),
    Law('force along the span', 'C_z^F', 'b3', 'c3', 'slip'),
    Law('roll moment', 'C_x^M', 'a4', 'c4', 'attack'),
    Law('pitch moment', 'C_y^M', 'b5', 'c5', 'slip'),
    Law('yaw moment', 'C_z^M', 'a6', 'c6', 'attack'),
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


def law_rows(angles: WorkingAngles) -> FloatArray:
    """Linear map (12, 12) from the coefficients to the twelve quantities."""
    values, slopes = np.zeros((2, len(LAWS), len(COEFFICIENTS)))
    for row, law in enumerate(LAWS):
        angle = angles.attack if law.angle == 'attack' else angles.slip
        values[row, law.columns] = angle, 1.0
        slopes[row, law.columns[0]] = RANGE
    return np.vstack((values, slopes))


def law_spans(coefficients: FloatArray, std: FloatArray | None = None) -> FloatArray:
    """Span (12,) of each quantity's law over 15° of its angle.

    Parameters
    ----------
    coefficients
        Of the board, (12,).
    std
        Their std (12,): then the root mean square of what the laws may span, so
        that a law whose slope is not known yet has a span too.
    """
    variance = np.zeros(len(coefficients)) if std is None else std**2
    slopes = [law.columns[0] for law in LAWS]
    span = RANGE * np.sqrt(coefficients[slopes] ** 2 + variance[slopes])
    return np.concatenate((span, span))


def law_quantities(
    coefficients: FloatArray,
    covariance: FloatArray,
    angles: WorkingAngles,
    span: FloatArray | None = None,
) -> LawQuantities:
    """Value and slope of each law, and their std.

    Parameters
    ----------
    coefficients, covariance
        Of the board, (12,) and (12, 12), in the order of eq. 36.
    angles
        Mean working angles of the boards.
    span
        From `law_spans`, where it is not to be that of these coefficients.
    """
    rows = law_rows(angles)
    return LawQuantities(
        values=rows @ coefficients,
        sd=np.sqrt(np.einsum('ij,jk,ik->i', rows, covariance, rows)),
        span=law_spans(coefficients) if span is None else span,
    )
