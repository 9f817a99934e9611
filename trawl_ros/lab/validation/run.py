# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Validation of the model: runs cases in parallel, each in its own process, and reports them."""

import multiprocessing
import re
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import empty_folder, finite
from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
from trawl_ros.lab.report.measured import MeasuredValue, within
from trawl_ros.lab.report.page import Findings, Page, Section, write_page
from trawl_ros.lab.validation.cases import NAMES, TITLES, load_case, report_section
from trawl_ros.report.pictures import draw

PROCESS = multiprocessing.get_context('spawn')

LONG = ('steady_states', 'sentences', 'board_frame', 'hauls', 'flume')
"""Cases that take minutes; they start first so that none is left over at the end."""

COMMAND = 'trawl validate'

LEAD = 'hauls'
"""Case that answers the question of the report, and so is at its top."""


def validate(
    out: str | Path,
    cases: Sequence[str] = (),
    *,
    quick: bool = False,
    workers: int = 2,
    force: bool = False,
    on_case: Callable[[Section], None] = lambda case: None,
    on_progress: OnProgress = ignore,
) -> tuple[Section, ...]:
    """Check the model against closed forms, the paper and other programs, and write the report.

    Parameters
    ----------
    out
        Folder for ``validation.json``, ``report.html``, ``report.md`` and their figures.
    cases
        Names of the cases; by default all.
    quick
        True if each case runs on less, in seconds.
    workers
        Processes at a time.
    force
        True if an earlier report in ``out`` is replaced.
    on_case
        Called with each case as it ends.
    on_progress
        Called as cases end.

    Returns
    -------
    tuple of Section
        The cases in the order of the report; ``rows`` are their checks, each with ``value``,
        ``target`` and ``ok``.

    Raises
    ------
    TrawlError
        If there is no such case, or ``out`` holds files already or cannot be written to. A check
        that does not hold is part of the report.

    Examples
    --------
    >>> import tempfile
    >>> import trawl_ros
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     (case,) = trawl_ros.validate(folder, ['board_law'], quick=True)
    >>> all(check.ok for check in case.rows)
    True
    """
    folder, names = Path(out), tuple(dict.fromkeys(cases)) or NAMES
    for name in names:
        report_section(name)
    empty_folder(folder, force=force)
    finished: list[Section] = []
    for case in run_cases(names, folder, quick=quick, workers=workers):
        finished.append(case)
        on_case(case)
        on_progress(WorkProgress('validating', len(finished), len(names), 'cases', case.name))
    finished.sort(key=lambda case: NAMES.index(case.name))
    page = Page(
        name='report',
        title='Validation',
        command=COMMAND,
        method='Small version of each case.'
        if quick
        else 'Each case says what it is compared with.',
        data='validation',
        answer=_answer(finished),
        lead=LEAD,
    )
    record = {f'{case.name}.{row.key}': check_record(row) for case in finished for row in case.rows}
    write_page(folder, page, finished, record=record)
    return tuple(finished)


def _answer(finished: Sequence[Section]) -> str:
    """Return how far the model is from hauls at sea, where these are among the cases."""
    rows = {row.key: row for case in finished if case.name == LEAD for row in case.rows}
    if not rows:
        return ''
    return (
        f'Over {rows["points"].figure} points of published hauls at sea the median error is '
        f'{rows["median_error"].figure}; {rows["near"].what}: {rows["near"].figure}. For gears '
        'whose net plan is published the median is '
        f'{rows["median_error_of_published_plans"].figure}.'
    )


def run_cases(
    names: Sequence[str], folder: Path, *, quick: bool, workers: int
) -> Iterator[Section]:
    """Run cases and yield each as it ends; figures go into ``folder``/figures."""
    with ThreadPoolExecutor(workers) as threads:
        first = sorted(names, key=lambda name: name not in LONG)
        pending = [threads.submit(_apart, name, folder, quick) for name in first]
        try:
            for future in as_completed(pending):
                yield future.result()
        finally:
            threads.shutdown(wait=False, cancel_futures=True)


def _apart(name: str, folder: Path, quick: bool) -> Section:
    """Run one case in its own process, so that a crash of a reference code ends only that case."""
    with ProcessPoolExecutor(1, mp_context=PROCESS) as process:
        try:
            return process.submit(run_case, name, folder, quick=quick).result()
        except BrokenProcessPool:
            return _section(name, _broken('The process that ran it ended without a word.'), 0.0)


def run_case(name: str, folder: Path, *, quick: bool) -> Section:
    """Run one case in this process and draw its figures.

    If the model has no solution, the case fails and the report continues.
    """
    began = time.perf_counter()
    try:
        findings = load_case(name).run(quick)
    except TrawlError as error:
        findings = _broken(str(error))
    seconds = time.perf_counter() - began
    keys = [row.key for row in findings.rows]
    assert len(set(keys)) == len(keys), f'{name}: two checks share a key'
    assert all(re.fullmatch(r'\w+', key) for key in keys), f'{name}: {keys}'
    return _section(name, findings, seconds, folder)


def _broken(note: str) -> Findings:
    return Findings(
        (MeasuredValue('the case ran to its end', 0.0, '', within(0.0, of=1.0), note, key='ran'),)
    )


def _section(name: str, findings: Findings, seconds: float, folder: Path = Path()) -> Section:
    return Section(
        load_case(name).title,
        findings.rows,
        draw(folder, findings.drawings, f'figures/{name}_'),
        findings.tables,
        findings.text,
        TITLES[report_section(name)],
        name,
        f'{COMMAND} {name}',
        seconds,
    )


def check_record(check: MeasuredValue) -> dict[str, object]:
    """Return one check as plain values; unmeasured values are null."""
    assert check.target is not None
    return {
        'what': check.what,
        'measured': finite(check.value),
        'expected': check.target.expected,
        'tolerance': check.target.tolerance,
        'rule': check.target.rule,
        'unit': check.unit,
        'ok': check.ok,
        'note': check.note,
    }
