# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Estimate of a fit, with calibration errors of its tows, and innovations of a new window."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.error_terms import GROUP_OF, GROUPS, TERMS, ChannelError, model_errors
from trawl_ros.estimation.fit.estimate import (
    Estimate,
    Innovation,
    NetFactor,
    TowBias,
    undetermined,
)
from trawl_ros.estimation.fit.fit import Fit
from trawl_ros.estimation.fit.linearised import Linearised
from trawl_ros.estimation.fit.redundancy import shared_root, tow_roots
from trawl_ros.records.channels import CHANNELS

GATE = 3.0
"""Standard deviations at which an innovation's test ratio is 1."""


def innovation_of(linear: Linearised, fit: Fit, known: FloatArray) -> Innovation:
    """Innovations of a window.

    Parameters
    ----------
    linear
        The window, solved at the coefficients of the fit.
    fit
        Of the windows before it.
    known : (q, q) array
        Covariance of the coefficients before it.
    """
    (errors,) = replace(fit, windows=(linear,)).errors
    there = errors.present[0]
    own = (errors.noise[0] * np.array(fit.scales)[GROUP_OF])[there]
    shared = np.hstack(
        [errors.inputs[0][there], errors.calibration[0][there], errors.model[0][there]]
    )
    spread = linear.by_coefficients @ known @ linear.by_coefficients.T
    std = np.sqrt(own**2 + np.sum(shared**2, axis=1) + np.diag(spread))
    difference = linear.measured - linear.solved
    return Innovation(linear.channels, difference, std, (difference / (GATE * std)) ** 2)


def posterior_estimate(
    fit: Fit, revision: int, innovation: Innovation | None, converged: bool, reason: str
) -> Estimate:
    """Posterior estimate of a fit; the other arguments go into the estimate unchanged.

    A model that the data contradict knows less than it says: standard deviations are as many times
    larger as the misfit is (Birge 1932).
    """
    return Estimate(
        prior=fit.prior,
        revision=revision,
        stamp=max(linear.window.end_ns for linear in fit.windows),
        windows=len(fit.windows),
        values=np.array(fit.coefficients),
        covariance=fit.birge_ratio**2 * fit.posterior.covariance,
        condition_number=fit.posterior.condition_number,
        undetermined=undetermined(fit.posterior, fit.prior.names),
        noise_scales=dict(zip(GROUPS, fit.scales, strict=True)),
        tow_biases=biases_of_fit(fit),
        net=net_factors(fit),
        degrees_of_freedom=fit.degrees_of_freedom + fit.options.stated_noise_readings,
        confidence=fit.options.confidence,
        birge_ratio=fit.birge_ratio,
        cost=fit.cost,
        objective=fit.objective,
        innovation=innovation,
        converged=converged,
        reason=reason,
    )


def tow_biases(
    tow: int,
    terms: Sequence[ChannelError],
    values: FloatArray,
    root: FloatArray,
    means: Mapping[str, float],
) -> list[TowBias]:
    """Return the calibration errors of a tow by channel.

    Parameters
    ----------
    tow
        Its number.
    terms
        The p errors of calibration.
    values : (p,) array
        Their estimates, in prior std.
    root : (p, m) array
        Root of their posterior covariance.
    means
        Mean of each channel that the tow has.
    """
    biases = []
    for name in dict.fromkeys(term.channel for term in terms if term.channel in means):
        mean = float(means[name])
        size = np.array([(term.channel == name) * term.size(mean) for term in terms])
        biases.append(
            TowBias(
                tow=tow,
                channel=name,
                unit=CHANNELS[name].unit,
                value=float(size @ values),
                std=float(np.linalg.norm(size @ root)),
                known=float(np.linalg.norm(size)),
            )
        )
    return biases


def biases_of_fit(fit: Fit) -> tuple[TowBias, ...]:
    """Return the calibration errors by tow and channel, inputs included."""
    share, found = fit.options.tow_share, []
    terms = [replace(term, std=share * term.std) for term in TERMS]
    for part, every in zip(
        fit.elimination.tows, tow_roots(fit.elimination, fit.posterior.root), strict=True
    ):
        windows = [fit.windows[row].window for row in part.errors.rows]
        channels = dict.fromkeys(name for window in windows for name in window.means)
        means = {
            name: float(np.mean([w.means[name] for w in windows if name in w.means]))
            for name in channels
        }
        root = every[-len(terms) :]
        found += tow_biases(windows[0].tow, terms, part.calibration, root, means)
    return tuple(found)


def net_factors(fit: Fit) -> tuple[NetFactor, ...]:
    """Return the factors on drag and weight of the net, if they are estimated along."""
    if fit.net is None:
        return ()
    std = fit.options.net_std
    root = shared_root(fit.elimination, fit.posterior.root)[len(fit.coefficients) :]
    (rows,) = model_errors(fit.options).blocks('net')
    return tuple(
        NetFactor(what, float(value), float(known * np.linalg.norm(root[row])), float(known))
        for what, value, known, row in zip(('drag', 'weight'), fit.net, std, rows, strict=True)
        if known > 0.0
    )
