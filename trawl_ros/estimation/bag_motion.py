# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Fit of the tows in bags: of all of each, or of its steady parts alone."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from trawl_ros.bags.samples import SampleStream
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
from trawl_ros.effects.effect_set import effects_of
from trawl_ros.estimation.from_gear import NET_STD, board_prior
from trawl_ros.estimation.motion.fit import fit_motion, fit_steady
from trawl_ros.estimation.motion.fit_records import MotionOptions
from trawl_ros.estimation.motion.holdout import hold_out_states
from trawl_ros.estimation.motion.nuisances import layout_of, place_at
from trawl_ros.estimation.motion.outcome import MotionOutcome
from trawl_ros.estimation.motion.part_statistics import part_statistics
from trawl_ros.estimation.motion.parts import parts_of
from trawl_ros.estimation.motion.series import TowReadings, tow_readings
from trawl_ros.estimation.motion.stretches import FEWEST, StretchOptions, moving_tow
from trawl_ros.estimation.motion.towing.records import MovingTow
from trawl_ros.estimation.motion.towing.towed_gear import TowedGear
from trawl_ros.estimation.pipeline import Identification
from trawl_ros.estimation.tows import FoundWindows
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import build_model
from trawl_ros.model.water import build_water

STRETCHES = StretchOptions(step_s=3.0, stretch_s=30.0, knot_s=30.0, counter_knot_s=90.0)
"""Of a tow of hours; the linearised tow costs some twenty times less time than it took at sea."""

START_TOLERANCE = 0.5
"""Part of every std to which the steady parts alone are fitted, where the fit of all begins."""

STAGE = 'towing the model along'

Refused = Callable[[str], None]


def why_windows_alone(gear: GearRecord, *, prior: bool) -> str | None:
    """Reason, in a sentence, why a tow cannot be fitted as a chain of parts; None if it can."""
    if gear.pair is not None:
        return f'{gear.name} has no boards, and only their coefficients are learned so'
    if not prior:
        return 'the prior of the gear file takes part in any other fit'
    return None


def towed_gear(gear: GearRecord, *, net: bool) -> TowedGear:
    """Gear that is towed, with the effects that its file switches on.

    ``net`` is true if drag and weight of the net are estimated too.
    """
    return TowedGear(build_model(gear), effects_of(gear), net_std=NET_STD if net else 0.0)


def learn_from_motion(
    gear: GearRecord,
    identification: Identification | None,
    recordings: Sequence[FoundWindows],
    namespace: str,
    on_progress: OnProgress,
    *,
    net: bool = False,
    steady: bool = False,
) -> MotionOutcome:
    """Fit tows, from the estimate of their steady windows, or from the prior.

    Parameters
    ----------
    gear
        The gear as the model has it.
    identification
        At rest, with the windows of all recordings; None where no recording has one.
    recordings
        In the order in which the identification took them.
    namespace
        Of the topics.
    on_progress
        Called after each stretch that was towed, with the time (s) towed so far.
    net
        True if drag and weight of the net are estimated along.
    steady
        True if their steady parts alone are fitted.

    Raises
    ------
    TrawlError
        If no bag can be used, with a reason for each, or the model cannot be towed along them.
    """
    if identification is not None and identification.estimate is None:
        raise TrawlError(identification.why_not() or 'nothing is estimated')
    tows, numbers, refused = moving_tows(gear, recordings, namespace, on_progress)
    if not tows:
        raise TrawlError('; '.join(refused))
    return fit_tows(
        gear, identification, tows, numbers, refused, on_progress, net=net, steady=steady
    )


def fit_tows(
    gear: GearRecord,
    identification: Identification | None,
    tows: Sequence[MovingTow],
    numbers: Sequence[int],
    refused: Sequence[str],
    on_progress: OnProgress = ignore,
    *,
    net: bool = False,
    steady: bool = False,
) -> MotionOutcome:
    """Fit tows as chains of parts.

    Parameters
    ----------
    gear, identification, on_progress, net, steady
        As of `learn_from_motion`.
    tows, numbers, refused
        As `moving_tows` gives them.

    Raises
    ------
    TrawlError
        If the model cannot be towed along any stretch, or the fit does not converge and there are
        windows to fall back on.
    """
    estimate = None if identification is None else identification.estimate
    prior, options, towed = (
        board_prior(gear),
        MotionOptions(),
        towed_gear(gear, net=net),
    )
    start = None
    if identification is not None and estimate is not None:
        known = identification.estimator.fit.windows
        towed = replace(towed, near=tuple(linear.state for linear in known))
        layouts = [layout_of(tow, towed, options.model) for tow in tows]
        start = place_at(estimate.values, prior, layouts)
    done = 0.0

    def show(iteration: int, tow: int, stretch: int) -> None:
        nonlocal done
        done += tows[tow].stretch_s
        of = f' of {len(tows)}' if len(tows) > 1 else ''
        minute = (stretch + 1) * tows[tow].stretch_s / 60.0
        detail = f'step {iteration}, tow {tow + 1}{of}, minute {minute:.0f}'
        on_progress(WorkProgress(STAGE, done, None, 's', detail))

    own = options if steady else replace(options, tolerance=START_TOLERANCE)
    fit = fit_steady(towed, tows, prior, own, start, show)
    if not steady:
        if fit is not None and fit.converged and fit.readings:
            start = list(fit.parameters)
        fit = fit_motion(towed, tows, prior, options, start, show)
    if fit is None or not fit.readings:
        raise TrawlError('the model cannot be towed along any stretch of the tows')
    if identification is not None and not fit.converged:
        # Intervals of a place that is not at rest mean nothing, and the windows have theirs.
        what = 'the steady parts' if steady else 'the whole tow'
        raise TrawlError(f'the fit of {what} did not converge: {fit.reason}')
    held_out = hold_out_states(fit, prior, numbers, options)
    return MotionOutcome(fit, prior, tuple(numbers), tuple(refused), held_out)


def moving_tows(
    gear: GearRecord, recordings: Sequence[FoundWindows], namespace: str, on_progress: OnProgress
) -> tuple[list[MovingTow], list[int], list[str]]:
    """Read bags as tows in motion.

    Returns
    -------
    list
        The tows: of a bag whose inputs fall silent on the way, one for each part.
    list
        For each, the number of its bag's first tow among those of the windows, and one behind all
        of these for a bag without windows.
    list
        A sentence for each bag that cannot be used.
    """
    tows: list[MovingTow] = []
    numbers: list[int] = []
    refused: list[str] = []
    depth, first = build_water(gear).depth, 0
    every = sum(_tows_in(recording) for recording in recordings)
    for number, recording in enumerate(recordings):
        on_progress(WorkProgress('reading all of it', number, len(recordings), 'bags'))
        own = _tows_in(recording)
        samples = (sample for _, sample in SampleStream([Path(recording.name)], namespace))
        try:
            read = tow_readings(samples, depth, recording.name)
            for part in moving_parts(read, recording.name, statistics=True):
                tows.append(part)
                numbers.append(first if own else every + number)
        except TrawlError as error:
            refused.append(str(error))
        first += own
    return tows, numbers, refused


def _tows_in(recording: FoundWindows) -> int:
    return 1 + max((window.tow for window in recording.windows), default=-1)


def moving_parts(read: TowReadings, name: str, *, statistics: bool = False) -> Iterator[MovingTow]:
    """Divide a tow into parts along which the model can be towed, and these into stretches.

    Parameters
    ----------
    read, name
        Its readings, and its name for people.
    statistics
        True to compute the statistics of its steady and moving parts.

    Raises
    ------
    TrawlError
        If no part is long enough, or one is too long.
    """
    shortest = STRETCHES.settling_s + FEWEST * STRETCHES.stretch_s
    parts = parts_of(read, shortest)
    if not parts:
        raise TrawlError(
            f'{name}: counters, log or winches fall silent so often that no part of '
            f'{shortest:.0f} s is left'
        )
    for place, part in enumerate(parts, start=1):
        several = f', part {place}' if len(parts) > 1 else ''
        tow = moving_tow(part, name + several, STRETCHES)
        yield replace(tow, statistics=part_statistics(part, tow)) if statistics else tow
