# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Sea trials: identification and diagnosis from bags, and plan of the next trial.

Imports of figures, motion and onsets are slow, so they stand in the functions that need them.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from trawl_ros.bags.samples import SampleStream
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import empty_folder
from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
from trawl_ros.core.resources import packaged_bag
from trawl_ros.diagnosis.diagnosis import Diagnosis, unread
from trawl_ros.diagnosis.procedure import diagnose_windows
from trawl_ros.diagnosis.repair import source
from trawl_ros.estimation.bag_windows import read_tows
from trawl_ros.estimation.from_gear import estimator_options, identification_for
from trawl_ros.estimation.pipeline import NO_WINDOW
from trawl_ros.estimation.tows import FoundWindows, estimate_tows, numbered, require_distinct
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.records.topics import NAMESPACE

if TYPE_CHECKING:
    from trawl_ros.diagnosis.onset.tows import OnsetsInTow
    from trawl_ros.estimation.motion.outcome import MotionOutcome
    from trawl_ros.estimation.planning.plan import TrialPlan
    from trawl_ros.estimation.planning.states import Limits
    from trawl_ros.estimation.report.report import Report

DEFAULT_GEAR = 'kaifuha'

OnNote = Callable[[str], None]
"""Function of a sentence on input that is damaged or not used."""


def _silent(sentence: str) -> None:
    """Ignore a sentence."""


def identify(
    bags: Sequence[str | Path],
    *,
    gear: str | Path | GearRecord = DEFAULT_GEAR,
    out: str | Path | None = None,
    truth: str | Path | None = None,
    prior: bool = True,
    net: bool = False,
    namespace: str = NAMESPACE,
    motion: bool = True,
    scheduler: str | None = None,
    force: bool = False,
    on_note: OnNote = _silent,
    on_progress: OnProgress = ignore,
) -> 'Report':
    """Refit the board coefficients from bags, one bag per tow.

    For cross-validation each tow is left out in turn and predicted from the others; with a single
    tow, its steady states are left out.

    Parameters
    ----------
    bags
        Folders or files, or names of sample bags of the package.
    gear
        Gear of the model: record, file or name.
    out
        Folder for report, JSON and figures; nothing is written without it.
    truth
        Scenario that made the bags; its coefficients are compared with the estimates.
    prior
        True to use the gear file's prior; otherwise only its bounds are used.
    net
        True to estimate drag and weight of the net too.
    namespace
        Namespace of the topics.
    motion
        True to fit the whole tows, including hauling and veering, which takes a minute per hour of
        tow; meanwhile ``out`` contains the results of the steady windows. False to fit only their
        steady parts, in a quarter of that.
    scheduler
        Address of a Dask cluster that reads the bags. It runs code, so it must be trusted.
    force
        True to replace results of an earlier run in ``out``.
    on_note, on_progress
        Functions called with sentences on damaged or unused input, and with the progress.

    Returns
    -------
    Report
        Report with the ``estimate`` (values and covariance, SI), residuals, and held-out errors.
        ``chain`` is the fit of the tows, or ``chain_refused`` the reason why the steady windows
        alone were used.

    Raises
    ------
    TrawlError
        If no bag has a steady window or can be fitted in motion, with the reasons, a tow is given
        twice, or ``out`` contains files.

    Notes
    -----
    Processes that import the calling script read several bags in parallel. Its own work must
    therefore stand under ``if __name__ == '__main__':``.

    Examples
    --------
    A bag with two steady states of the coarse gear:

    >>> import trawl_ros
    >>> report = trawl_ros.identify(['tow_1'], gear='coarse.yaml', motion=False)
    >>> report.estimate.values.shape, len(report.windows)
    ((12,), 2)
    """
    from trawl_ros.estimation.bag_motion import learn_from_motion, why_windows_alone
    from trawl_ros.estimation.report.page import write_report
    from trawl_ros.estimation.report.report import report, report_without_windows
    from trawl_ros.scenario.scenario import true_coefficients

    if out is not None:
        empty_folder(Path(out), force=force)
    known = None if truth is None else true_coefficients(truth)
    options = estimator_options(prior=prior, net=net)
    record = _gear(gear)
    paths = [packaged_bag(bag) for bag in bags]
    recordings = read_tows(paths, record, namespace, scheduler=scheduler, on_progress=on_progress)
    _note(recordings, on_note)
    require_distinct(recordings)
    why_not = why_windows_alone(record, prior=prior)
    if len(reasons := _reasons(recordings)) == len(recordings):
        unsettled = [one for one in recordings if (one.why_not or '').startswith(NO_WINDOW)]
        if not motion or why_not or not unsettled:
            raise TrawlError('; '.join(reasons))
        on_note('No bag has a steady window: the whole tow is fitted instead.')
        try:
            whole = learn_from_motion(record, None, unsettled, namespace, on_progress, net=net)
        except TrawlError as error:
            raise TrawlError(f'{"; ".join(reasons)}; and no fit in motion: {error}') from error
        rejections = [recording.rejections for recording in unsettled]
        result = report_without_windows(whole, rejections, record, known)
        if out is not None:
            write_report(result, Path(out))
        return result
    identification = identification_for(record, estimator_options=options)
    names = estimate_tows(identification, recordings, on_progress)
    if reason := identification.why_not():
        raise TrawlError(f'{", ".join(map(str, bags))}: {reason}')
    learned: MotionOutcome | None = None
    refused = why_not or ''
    if not refused:
        if motion and out is not None:
            early = report(identification, known, tows=names, gear=record, on_progress=on_progress)
            write_report(early, Path(out))
        try:
            learned = learn_from_motion(
                record, identification, recordings, namespace, on_progress,
                net=net, steady=not motion,
            )  # fmt: skip
        except TrawlError as reason:
            refused = str(reason)
    found = report(
        identification, known, tows=names, gear=record, on_progress=on_progress, chain=learned
    )
    result = replace(found, chain_refused=refused)
    if out is not None:
        write_report(result, Path(out))
    return result


def diagnose(
    bags: Sequence[str | Path],
    *,
    baseline: Sequence[str | Path] = (),
    gear: str | Path | GearRecord = DEFAULT_GEAR,
    out: str | Path | None = None,
    namespace: str = NAMESPACE,
    scheduler: str | None = None,
    force: bool = False,
    onset: bool = False,
    on_note: OnNote = _silent,
    on_progress: OnProgress = ignore,
) -> Diagnosis:
    """Find where model and bags disagree, and name the effect that the model lacks.

    Parameters
    ----------
    bags
        Tows to examine: folders or files.
    baseline
        Tows with the gear in order.
    gear, out, namespace, scheduler, force, on_note, on_progress
        As in `identify`. If an effect is named, ``model.yaml`` is written to ``out`` too.
    onset
        True to look in each of ``bags`` for effects that begin in it, a minute per hour of tow.

    Returns
    -------
    Diagnosis
        Diagnosis with ``verdict``, reason, evidence, and the ``repair`` if there is one.

    Raises
    ------
    TrawlError
        If a bag cannot be read, a tow is given twice, or ``out`` contains files.

    Examples
    --------
    Two steady states are too few for a verdict:

    >>> import trawl_ros
    >>> trawl_ros.diagnose(['tow_1'], gear='coarse.yaml').verdict
    'NOT_TESTABLE'
    """
    if out is not None:
        empty_folder(Path(out), force=force)
    record = _gear(gear)
    paths = [packaged_bag(bag) for bag in (*baseline, *bags)]
    recordings = read_tows(paths, record, namespace, scheduler=scheduler, on_progress=on_progress)
    _note(recordings, on_note)
    require_distinct(recordings)
    windows, names = numbered(recordings)
    known, _ = numbered(recordings[: len(baseline)])
    if len(reasons := _reasons(recordings)) == len(recordings):
        result = unread(record, names, '; '.join(reasons))
    else:
        in_order = frozenset(window.tow for window in known)
        result = diagnose_windows(record, windows, names, in_order, on_progress)
        if onset:
            result = replace(
                result, onsets=_onsets(result, paths[len(baseline) :], namespace, on_progress)
            )
    if out is not None:
        from trawl_ros.diagnosis.report.writing import write_diagnosis

        write_diagnosis(result, [source(path) for path in paths], Path(out))
    return result


def plan_trial(
    gear: str | Path = DEFAULT_GEAR,
    *,
    hours: float = 6.0,
    limits: 'Limits | None' = None,
    out: str | Path | None = None,
    force: bool = False,
    on_progress: OnProgress = ignore,
) -> 'TrialPlan':
    """Plan the sea trial that determines the boards best in a given time.

    Parameters
    ----------
    gear
        File or name.
    hours
        Time at sea, h.
    limits
        Warp lengths (m) and speeds (m/s) to choose from, largest tension (N), depth of water (m).
    out
        Folder for ``plan.json``, the scenario ``trial.yaml`` and a picture.
    force
        True to replace results of an earlier run in ``out``.
    on_progress
        Function called with the progress.

    Returns
    -------
    TrialPlan
        The ``trial`` with its legs, the gain of each leg, what a fit of the whole tow will know,
        and the paper's sweep for comparison.

    Raises
    ------
    TrawlError
        If there is no possible manoeuvre, or no time for two legs.

    Examples
    --------
    >>> import trawl_ros
    >>> from trawl_ros.estimation.planning.states import Limits
    >>> limits = Limits(lengths=(300.0, 400.0), speeds=(2.1, 2.3), shorter=())
    >>> plan = trawl_ros.plan_trial('coarse.yaml', hours=1.5, limits=limits)
    >>> len(plan.gains)
    4
    """
    from trawl_ros.estimation.planning.plan import plan_for, towed_plan

    if out is not None:
        empty_folder(Path(out), force=force)
    record = load_gear(gear)
    plan = plan_for(record, hours=hours, limits=limits, on_progress=on_progress)
    plan = towed_plan(record, plan, on_progress)
    if out is not None:
        from trawl_ros.estimation.planning.writing import write_plan

        write_plan(plan, str(gear), Path(out))
    return plan


def _onsets(
    diagnosis: Diagnosis, paths: Sequence[Path], namespace: str, on_progress: OnProgress
) -> 'tuple[OnsetsInTow, ...]':
    """Find onsets in each tow, with the fitted boards or those of the gear file."""
    from trawl_ros.diagnosis.onset.knowledge import of_gear_file
    from trawl_ros.diagnosis.onset.tows import by_estimate, onsets_in

    known = of_gear_file(diagnosis.gear)
    if diagnosis.base is not None:
        windows = (*diagnosis.split.fitted, *diagnosis.split.kept_back)
        board = diagnosis.base.fit.prior.slice_of('coefficients')
        known = by_estimate(diagnosis.base.estimate, board, windows)
    found = []
    for number, path in enumerate(paths):
        on_progress(WorkProgress('looking for onsets', number, len(paths), 'tows'))
        samples = (sample for _, sample in SampleStream([path], namespace))
        found.append(onsets_in(diagnosis.gear, known, path.name, samples))
    return tuple(found)


def _gear(gear: str | Path | GearRecord) -> GearRecord:
    return gear if isinstance(gear, GearRecord) else load_gear(gear)


def _reasons(recordings: Sequence[FoundWindows]) -> list[str]:
    """Return a sentence for each recording that cannot be used."""
    return [
        f'{recording.name}: {recording.why_not}'
        for recording in recordings
        if recording.why_not is not None
    ]


def _note(recordings: Sequence[FoundWindows], on_note: OnNote) -> None:
    for recording in recordings:
        for problem in recording.problems:
            on_note(f'Damaged: {problem}')
        if recording.why_not is not None:
            on_note(f'Not used: {recording.name}: {recording.why_not}')
