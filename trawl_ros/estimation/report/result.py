# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Content of ``identification.json``."""

import math

from trawl_ros.core.files import finite
from trawl_ros.estimation.fit.laws import QUANTITIES
from trawl_ros.estimation.fit.objective import PAPER_CHANNELS
from trawl_ros.estimation.report.chain import chain_result
from trawl_ros.estimation.report.net import net_result
from trawl_ros.estimation.report.report import Report, coefficient_rows
from trawl_ros.estimation.report.residuals import ChannelResiduals
from trawl_ros.estimation.windows.noise_density import noise_densities

COEFFICIENT_KEYS = 'start', 'value', 'std', 'low', 'high', 'shrink', 'determined'
"""Keys of a coefficient."""

BIAS_KEYS = 'unit', 'value', 'std', 'known'
"""Keys of a bias."""


def result(report: Report) -> dict[str, object]:
    """Build the content of ``identification.json``; numbers that do not exist are None."""
    estimate, errors = report.estimate, report.errors
    asked = report.chain is not None or report.chain_refused
    return {
        'windows': estimate.windows,
        'rejected': dict(report.rejected),
        'objective': {key: finite(value) for key, value in report.objectives.items()},
        'coefficients': {
            row['name']: {key: row[key] for key in COEFFICIENT_KEYS}
            for row in coefficient_rows(report)
        },
        'channels': {
            channel.name: {
                'unit': channel.unit,
                'mnae_start': finite(errors['start'][i]),
                'mnae_end': finite(errors['end'][i]),
                'mnae_held_out': finite(errors['held_out'][i]),
            }
            for i, channel in enumerate(PAPER_CHANNELS)
        },
        'condition_number': finite(estimate.condition_number),
        'undetermined': [str(combination) for combination in estimate.undetermined],
        'converged': estimate.converged,
        'reason': estimate.reason,
        'active_bounds': list(estimate.active_bounds),
        'covariance': estimate.covariance.tolist(),
        'singular_values': report.spectrum.singular.tolist(),
        'weak_combinations': [
            {
                'names': list(combination.names),
                'weights': dict(zip(estimate.names, combination.weights.tolist(), strict=True)),
                'std': finite(combination.std),
            }
            for combination in estimate.undetermined
        ],
        'misfit': report.misfit,
        'noise_scales': dict(estimate.noise_scales),
        'noise_densities': dict(noise_densities(report.windows)),
        'net': net_result(report.estimate.net),
        'prior_used': report.prior_weight > 0.0,
        'held_out_by': report.held_out.by,
        'accepted': _accepted(report),
        'tows': _tows(report),
        'sensors': {row.channel: row.record() for row in report.sensors},
        'residuals': {row.channel: _statistics(row) for row in report.residuals},
        'innovations': {row.channel: _statistics(row) for row in report.innovations},
        'laws': _laws(report),
        'rejected_last': dict(report.found),
        **({'chain': chain_result(report)} if asked else {}),
    }


def _laws(report: Report) -> dict[str, object] | None:
    """Value and slope of each law at the mean working angle, by name."""
    if report.laws is None:
        return None
    known = report.laws.quantities
    return {
        'attack_deg': math.degrees(report.laws.angles.attack),
        'slip_deg': math.degrees(report.laws.angles.slip),
        'quantities': {
            name: {
                'value': float(known.values[i]),
                'std': float(known.sd[i]),
                'span': float(known.span[i]),
                'well_known': bool(known.well_known[i]),
            }
            for i, name in enumerate(QUANTITIES)
        },
    }


def _accepted(report: Report) -> dict[str, object]:
    """Numbers of windows and, per channel, readings in the fit."""
    readings: dict[str, int] = {}
    for window in report.windows:
        for name, count in window.counts.items():
            readings[name] = readings.get(name, 0) + count
    return {'windows': len(report.windows), 'readings': readings}


def _tows(report: Report) -> list[dict[str, object]]:
    tows = []
    for tow in report.by_tow:
        tows.append(
            {
                'name': tow.name,
                'windows': tow.windows,
                'states': tow.states,
                'mnae_held_out': {
                    channel.name: finite(error)
                    for channel, error in zip(PAPER_CHANNELS, tow.held_out, strict=True)
                },
                'biases': {
                    bias.channel: {key: getattr(bias, key) for key in BIAS_KEYS}
                    for bias in report.estimate.tow_biases
                    if bias.tow == tow.tow
                },
            }
        )
    return tows


def _statistics(row: ChannelResiduals) -> dict[str, object]:
    white = row.whiteness
    return {
        'unit': row.unit,
        'windows': len(row.values),
        'mean': finite(row.mean),
        'std': finite(row.std),
        'stated_std': finite(row.stated_std),
        'test_ratio': finite(row.test_ratio),
        'whiteness': None
        if white is None
        else {
            'statistic': white.statistic,
            'lags': white.lags,
            'p_value': white.p_value,
            'white': white.white,
        },
    }
