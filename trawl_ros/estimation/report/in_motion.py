# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Report on tows without one steady window: all of it is by their motion."""

from collections.abc import Sequence

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.estimate import Estimate, active_bounds, is_determined
from trawl_ros.estimation.fit.objective import stack
from trawl_ros.estimation.motion.outcome import MotionOutcome
from trawl_ros.estimation.report.holdout import HeldOut
from trawl_ros.estimation.report.report import Report
from trawl_ros.estimation.report.spectrum import spectrum
from trawl_ros.estimation.windows.records import REASONS, Rejections
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import build_board


def report_in_motion(
    motion: MotionOutcome,
    rejections: Sequence[Rejections],
    gear: GearRecord,
    truth: FloatArray | None = None,
) -> Report:
    """Compute the report of tows that were learned from in motion alone.

    Parameters
    ----------
    motion
        Outcome of their fit.
    rejections
        Of the recordings, none of which has a window.
    gear
        Gear of the boards.
    truth
        True coefficients (q,), where known.
    """
    every, prior, none = Rejections(), motion.prior, stack(())
    for rejected in rejections:
        every.counts.update(rejected.counts)
        every.sentences.update(rejected.sentences)
    estimate = estimate_in_motion(motion)
    return Report(
        estimate=estimate,
        prior=prior,
        prior_weight=1.0,
        truth=None if truth is None else np.asarray(truth, dtype=float),
        rejected={key: every.counts[key] for key in REASONS if every.counts[key]},
        found={key: every.sentences[key] for key in REASONS if key in every.sentences},
        windows=(),
        tows=motion.names,
        measured=none,
        at_start=none,
        at_end=none,
        held_out=HeldOut('tow', 0, none),
        at_truth=None,
        residuals=(),
        innovations=(),
        course=(),
        history=(),
        spectrum=spectrum(estimate.covariance, prior, 1.0),
        law=build_board(gear).law,
        laws=None,
        motion=motion,
    )


def estimate_in_motion(motion: MotionOutcome) -> Estimate:
    """Estimate by a fit in motion, in the terms of one of steady windows."""
    fit, prior, std = motion.fit, motion.prior, motion.std
    ends = [linear.tow.start_ns + int(1e9 * linear.tow.middles[-1]) for linear in fit.linear]
    return Estimate(
        names=prior.names,
        revision=1,
        stamp=max(ends),
        windows=0,
        values=fit.values,
        std=std,
        covariance=fit.covariance,
        low=motion.low,
        high=motion.high,
        shrink=1.0 - std / prior.std,
        determined=is_determined(fit.values, std, prior),
        active_bounds=active_bounds(fit.values, prior),
        condition_number=float('nan'),
        undetermined=(),
        noise_scales={},
        tow_biases=(),
        net=fit.net,
        degrees_of_freedom=float('inf'),
        birge_ratio=1.0,
        cost=fit.cost,
        objective=float('nan'),
        innovation=None,
        converged=fit.converged,
        reason=fit.reason,
    )
