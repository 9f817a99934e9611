# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Calibration errors of each tow's instruments, and factors on drag and weight of the net."""

import numpy as np

from trawl_ros.estimation.fit.error_terms import TERMS
from trawl_ros.estimation.fit.estimate import NetFactor, TowBias
from trawl_ros.estimation.fit.fit import Fit
from trawl_ros.estimation.fit.redundancy import calibration_root, joint_root
from trawl_ros.records.channels import CHANNELS


def tow_biases(fit: Fit) -> tuple[TowBias, ...]:
    """Return the calibration errors by tow and channel, inputs included."""
    share = fit.scheme.tow_share
    joint = joint_root(fit.elimination, fit.posterior.root)
    biases = []
    for tow in fit.elimination.tows:
        root = calibration_root(tow, joint)
        windows = [fit.windows[row].window for row in tow.errors.rows]
        for name in dict.fromkeys(term.channel for term in TERMS):
            means = [window.means[name] for window in windows if name in window.means]
            if not means:
                continue
            size = np.array(
                [
                    share * term.std * (float(np.mean(means)) if term.relative else 1.0)
                    if term.channel == name
                    else 0.0
                    for term in TERMS
                ]
            )
            biases.append(
                TowBias(
                    tow=windows[0].tow,
                    channel=name,
                    unit=CHANNELS[name].unit,
                    value=float(size @ tow.calibration),
                    std=float(np.linalg.norm(size @ root)),
                    known=float(np.linalg.norm(size)),
                )
            )
    return tuple(biases)


def net_factors(fit: Fit) -> tuple[NetFactor, ...]:
    """Return the factors on drag and weight of the net, if they are estimated along."""
    if fit.net is None:
        return ()
    std = fit.scheme.net_std
    root = joint_root(fit.elimination, fit.posterior.root)
    (rows,) = fit.scheme.model_errors.blocks('net')
    return tuple(
        NetFactor(what, float(value), float(known * np.linalg.norm(root[row])), float(known))
        for what, value, known, row in zip(('drag', 'weight'), fit.net, std, rows, strict=True)
        if known > 0.0
    )
