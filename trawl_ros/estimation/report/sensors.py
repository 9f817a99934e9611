# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Measured and predicted values, sensor by sensor, in the units of the field."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.files import finite
from trawl_ros.estimation.fit.linearised import Linearised
from trawl_ros.records.channels import CHANNELS, MEASURED

STANDARD_GRAVITY_M_S2 = 9.80665

FIELD_UNITS = {
    'N': ('t', 1e-3 / STANDARD_GRAVITY_M_S2),
    'rad': ('°', 180.0 / np.pi),
    'm': ('m', 1.0),
}
"""Unit of the field for each SI unit, and the factor to it."""

CASES = {
    'gear_file': 'gear file as it is',
    'start': 'start values',
    'refitted': 'refitted',
}
"""Coefficients of the predictions, and their headings."""


@dataclass(frozen=True)
class PredictedSensor:
    """Prediction of a sensor over n windows: mean, and mean absolute error, in its field unit."""

    mean: float
    error: float


@dataclass(frozen=True)
class SensorComparison:
    """Comparison of a sensor with the model.

    Attributes
    ----------
    channel, unit
        Channel, and the unit of the field of all values.
    windows
        Number of windows that are compared.
    measured
        Mean of the readings.
    predicted
        Predictions by each of `CASES` that is known.
    """

    channel: str
    unit: str
    windows: int
    measured: float
    predicted: Mapping[str, PredictedSensor]

    def record(self) -> dict[str, object]:
        """Record for JSON."""
        return {
            'unit': self.unit,
            'windows': self.windows,
            'measured': self.measured,
            **{
                case: {'mean': finite(own.mean), 'error': finite(own.error)}
                for case, own in self.predicted.items()
            },
        }


def compare_sensors(
    cases: Mapping[str, Sequence[Linearised | None]],
) -> tuple[SensorComparison, ...]:
    """Compare each sensor with its predictions, over the windows that all cases can predict.

    Parameters
    ----------
    cases
        Windows solved with each of `CASES`; None where the model has no steady state.
    """
    rows = []
    together = [every for every in zip(*cases.values(), strict=True) if None not in every]
    for name in MEASURED:
        pairs = [
            [(one.measured[place], one.solved[place]) for one in every if one is not None]
            for every in together
            if every[0] is not None and name in every[0].channels
            for place in [every[0].channels.index(name)]
        ]
        if not pairs:
            continue
        unit, factor = FIELD_UNITS[CHANNELS[name].unit]
        measured, solved = factor * np.moveaxis(np.array(pairs), 2, 0)
        means, errors = solved.mean(axis=0), np.abs(measured - solved).mean(axis=0)
        predicted = {
            case: PredictedSensor(float(mean), float(error))
            for case, mean, error in zip(cases, means, errors, strict=True)
        }
        rows.append(
            SensorComparison(name, unit, len(pairs), float(measured[:, 0].mean()), predicted)
        )
    return tuple(rows)


def sensor_cells(row: SensorComparison) -> list[str]:
    """Cells of a table: sensor, measured mean, and each prediction with its mean absolute error."""
    return [
        row.channel.replace('_', ' '),
        f'{row.measured:.1f} {row.unit}',
        *(f'{own.mean:.1f} ({own.error:.2f})' for own in row.predicted.values()),
    ]


def sensor_headings(rows: Sequence[SensorComparison]) -> list[str]:
    """Headings of the predictions."""
    return [CASES[case] for case in rows[0].predicted] if rows else []
