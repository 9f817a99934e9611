"""Sea trials: identification and diagnosis from their bags, and the plan of a next one.

What one of them does without is imported in the others: figures, motion and onsets take their time.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from trawl_ros.bags.samples import SampleStream
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import empty_folder
from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
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
    from trawl_ros.estimation.planning.plan import TrialPlan
    from trawl_ros.estimation.planning.states import Limits
    from trawl_ros.estimation.report.report import Report

DEFAULT_GEAR = 'kaifuha'

OnNote = Callable[[str], None]
"""Takes a sentence on input that was damaged or not used."""


def _silent(sentence: str) -> None:
    """Take no notice of a sentence."""


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
    """Refit the twelve board coefficients of eq. 14 from bags, each of them a tow.

    Each tow is left out in turn and predicted from the others; with one, its steady states are.

    Parameters
    ----------
    bags
        Folders or files.
    gear
        The gear as the model has it: a record, a file, or a name.
    out
        Folder for page, JSON and figures; none are written without.
    truth
        Scenario that made the bags, whose coefficients are set beside the estimates.
    prior
        True if the gear file's prior takes part; else the data decide, within the bounds.
    net
        True if drag and weight of the net are estimated along.
    namespace
        Of the topics.
    motion
        True if all of the tows is learned from, hauling and veering included, beside their steady
        windows, which takes minutes for each hour of tow; ``out`` has the results of the windows
        meanwhile. False for the windows alone.
    scheduler
        Address of a Dask cluster that reads the bags. A scheduler runs code: it must be trusted.
    force
        True if results of an earlier run in ``out`` are replaced.
    on_note, on_progress
        Called with what is damaged or not used, and as the work goes on.

    Returns
    -------
    Report
        With ``estimate`` of the steady windows (values and covariance, SI), residuals, what was
        held out; ``motion`` by all of the tows, or ``motion_refused`` with the reason why not.
        Without one steady window ``estimate`` is that by all of the tows.

    Raises
    ------
    TrawlError
        If no bag has a steady window, or can be learned from in motion, with the reasons, a tow is
        given twice, or ``out`` holds files already.

    Notes
    -----
    Several bags are read by processes that import the script which calls this: what that does
    must stand under ``if __name__ == '__main__':``.

    Examples
    --------
    A bag with two steady states of the coarse gear, and nothing but these:

    >>> import trawl_ros
    >>> report = trawl_ros.identify(['tow_1'], gear='coarse.yaml', motion=False)
    >>> report.estimate.values.shape, len(report.windows)
    ((12,), 2)
    """
    from trawl_ros.estimation.bag_motion import learn_from_motion, why_windows_alone
    from trawl_ros.estimation.report.in_motion import report_in_motion
    from trawl_ros.estimation.report.page import write_report
    from trawl_ros.estimation.report.report import report
    from trawl_ros.scenario.scenario import true_coefficients

    if out is not None:
        empty_folder(Path(out), force=force)
    known = None if truth is None else true_coefficients(truth)
    options = estimator_options(prior=prior, net=net)
    record = _gear(gear)
    paths = [Path(bag) for bag in bags]
    recordings = read_tows(paths, record, namespace, scheduler=scheduler, on_progress=on_progress)
    _note(recordings, on_note)
    require_distinct(recordings)
    why_not = why_windows_alone(record, prior=prior)
    if len(reasons := _reasons(recordings)) == len(recordings):
        unsettled = [one for one in recordings if (one.why_not or '').startswith(NO_WINDOW)]
        if not motion or why_not or not unsettled:
            raise TrawlError('; '.join(reasons))
        on_note('No bag has a steady window: all of the tow is learned from.')
        try:
            learned = learn_from_motion(record, None, unsettled, namespace, on_progress, net=net)
        except TrawlError as error:
            raise TrawlError(f'{"; ".join(reasons)}; nor in motion: {error}') from error
        rejections = [recording.rejections for recording in unsettled]
        result = report_in_motion(learned, rejections, known)
        if out is not None:
            write_report(result, Path(out))
        return result
    identification = identification_for(record, estimator_options=options)
    names = estimate_tows(identification, recordings, on_progress)
    if reason := identification.why_not():
        raise TrawlError(f'{", ".join(map(str, bags))}: {reason}')
    result = report(identification, known, tows=names, gear=record, on_progress=on_progress)
    if out is not None:
        write_report(result, Path(out))
    if motion:
        try:
            if why_not:
                raise TrawlError(why_not)
            learned = learn_from_motion(
                record, identification, recordings, namespace, on_progress, net=net
            )
            result = replace(result, motion=learned)
        except TrawlError as reason:
            result = replace(result, motion_refused=str(reason))
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
        Tows of when the gear was known to be in order.
    gear, out, namespace, scheduler, force, on_note, on_progress
        As in `identify`. Where an effect is named, ``out`` also takes ``model.yaml``.
    onset
        True if each of ``bags`` is watched for what begins in it, a minute for each hour of tow.

    Returns
    -------
    Diagnosis
        With ``verdict``, reason, evidence, and the ``repair`` where there is one.

    Raises
    ------
    TrawlError
        If a bag cannot be read, a tow is given twice, or ``out`` holds files already.

    Examples
    --------
    Two steady states are too few to tell anything:

    >>> import trawl_ros
    >>> trawl_ros.diagnose(['tow_1'], gear='coarse.yaml').verdict
    'NOT_TESTABLE'
    """
    if out is not None:
        empty_folder(Path(out), force=force)
    record = _gear(gear)
    paths = [Path(bag) for bag in (*baseline, *bags)]
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
    """Plan the trial that tells most about the boards in a given time at sea.

    Parameters
    ----------
    gear
        A file or a name.
    hours
        Time at sea.
    limits
        Warp lengths (m) and speeds (m/s) to choose from, largest tension (N), depth of water (m).
    out
        Folder for ``plan.json``, the scenario ``trial.yaml`` and a picture.
    force
        True if results of an earlier run in ``out`` are replaced.
    on_progress
        Called as manoeuvres are explored.

    Returns
    -------
    TrialPlan
        The ``trial`` with its legs, what each leg gains, and the paper's sweep beside it.

    Raises
    ------
    TrawlError
        If there is nothing to choose from, or no time for two legs.

    Examples
    --------
    >>> import trawl_ros
    >>> from trawl_ros.estimation.planning.states import Limits
    >>> limits = Limits(lengths=(300.0, 400.0), speeds=(2.1, 2.3), shorter=())
    >>> plan = trawl_ros.plan_trial('coarse.yaml', hours=1.5, limits=limits)
    >>> len(plan.gains)
    4
    """
    from trawl_ros.estimation.planning.plan import plan_for

    if out is not None:
        empty_folder(Path(out), force=force)
    plan = plan_for(load_gear(gear), hours=hours, limits=limits, on_progress=on_progress)
    if out is not None:
        from trawl_ros.estimation.planning.writing import write_plan

        write_plan(plan, str(gear), Path(out))
    return plan


def _onsets(
    diagnosis: Diagnosis, paths: Sequence[Path], namespace: str, on_progress: OnProgress
) -> 'tuple[OnsetsInTow, ...]':
    """Onsets in each tow, by the boards as they were fitted, or else by the gear file."""
    from trawl_ros.diagnosis.onset.knowledge import of_gear_file
    from trawl_ros.diagnosis.onset.tows import by_estimate, onsets_in

    known = of_gear_file(diagnosis.gear)
    if diagnosis.base is not None:
        windows = (*diagnosis.split.deciding, *diagnosis.split.kept_back)
        known = by_estimate(diagnosis.base.estimate, windows)
    found = []
    for number, path in enumerate(paths):
        on_progress(WorkProgress('watching for what begins', number, len(paths), 'tows'))
        samples = (sample for _, sample in SampleStream([path], namespace))
        found.append(onsets_in(diagnosis.gear, known, path.name, samples))
    return tuple(found)


def _gear(gear: str | Path | GearRecord) -> GearRecord:
    return gear if isinstance(gear, GearRecord) else load_gear(gear)


def _reasons(recordings: Sequence[FoundWindows]) -> list[str]:
    """Sentences on the recordings that cannot be used."""
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
