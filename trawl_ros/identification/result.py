"""The report as ``identification.json`` has it."""

import math
from typing import Any

from trawl_ros.identification.objective import PAPER_CHANNELS
from trawl_ros.identification.report import Report
from trawl_ros.model.board import COEFFICIENTS


def result(report: Report) -> dict[str, Any]:
    """Build the content of ``identification.json``; numbers that do not exist are None."""
    estimate, errors = report.estimate, report.errors
    return {
        'windows': estimate.windows,
        'rejected': dict(report.rejected),
        'objective': {key: _number(value) for key, value in report.objectives.items()},
        'coefficients': {
            name: {
                'start': float(report.prior.start[i]),
                'value': float(estimate.values[i]),
                'std': float(estimate.std[i]),
                'low': float(estimate.low[i]),
                'high': float(estimate.high[i]),
                'determined': estimate.determined[i],
            }
            for i, name in enumerate(COEFFICIENTS)
        },
        'channels': {
            channel.name: {
                'unit': channel.unit,
                'mnae_start': _number(errors['start'][i]),
                'mnae_end': _number(errors['end'][i]),
                'mnae_held_out': _number(errors['held_out'][i]),
            }
            for i, channel in enumerate(PAPER_CHANNELS)
        },
        'condition_number': _number(estimate.condition_number),
        'undetermined': [str(combination) for combination in estimate.undetermined],
        'converged': estimate.converged,
        'reason': estimate.reason,
    }


def _number(value: float) -> float | None:
    # JSON has neither NaN nor infinity.
    return float(value) if math.isfinite(value) else None
