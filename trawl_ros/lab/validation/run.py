"""Runner of cases, several at a time, each in a process of its own."""

import multiprocessing
import re
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import write_figure
from trawl_ros.lab.report.check import CaseOutcome, Check, TextTable
from trawl_ros.lab.validation.cases import load_case, section_of
from trawl_ros.report.rendering import DPI

PROCESS = multiprocessing.get_context('spawn')

LONG = ('steady_states', 'sentences')
"""Cases that take minutes, and are started first so that none is left over at the end."""


@dataclass(frozen=True)
class CasePicture:
    """A figure that was drawn: its file in the report's folder, and its caption."""

    file: str
    caption: str


@dataclass(frozen=True)
class Finished:
    """A case that was run, with its ``seconds`` of wall clock."""

    name: str
    title: str
    section: str
    checks: tuple[Check, ...]
    pictures: tuple[CasePicture, ...]
    tables: tuple[TextTable, ...]
    text: str
    seconds: float

    @property
    def ok(self) -> bool:
        """True if every check of the case holds."""
        return all(check.ok for check in self.checks)


def run_cases(
    names: Sequence[str], folder: Path, *, small: bool, workers: int
) -> Iterator[Finished]:
    """Run cases and give each as it ends; figures go into ``folder``/figures.

    Raises
    ------
    TrawlError
        If there is no case of one of these names.
    """
    for name in names:
        section_of(name)
    (folder / 'figures').mkdir(parents=True, exist_ok=True)
    with ThreadPoolExecutor(workers) as threads:
        first = sorted(names, key=lambda name: name not in LONG)
        pending = [threads.submit(_apart, name, folder, small) for name in first]
        try:
            for future in as_completed(pending):
                yield future.result()
        finally:
            threads.shutdown(wait=False, cancel_futures=True)


def _apart(name: str, folder: Path, small: bool) -> Finished:
    """Run one case in a process of its own, which a crash of a reference code ends alone."""
    with ProcessPoolExecutor(1, mp_context=PROCESS) as process:
        try:
            return process.submit(run_case, name, folder, small=small).result()
        except BrokenProcessPool:
            note = 'The process that ran it ended without a word.'
            check = Check('ran', 'the case ran to its end', 0.0, 1.0, note=note)
            case = load_case(name)
            return Finished(name, case.title, section_of(name), (check,), (), (), '', 0.0)


def run_case(name: str, folder: Path, *, small: bool) -> Finished:
    """Run one case here and draw its figures.

    A case whose model has no answer is a case that fails, not the end of the report.
    """
    case = load_case(name)
    began = time.perf_counter()
    try:
        outcome = case.run(small)
    except TrawlError as error:
        check = Check('ran', 'the case ran to its end', 0.0, 1.0, note=str(error))
        outcome = CaseOutcome((check,))
    seconds = time.perf_counter() - began
    pictures = []
    for drawing in outcome.drawings:
        file = f'figures/{name}_{drawing.name}.png'
        write_figure(folder / file, drawing.figure, DPI)
        pictures.append(CasePicture(file, drawing.caption))
    keys = [check.key for check in outcome.checks]
    assert len(set(keys)) == len(keys), f'{name}: two checks share a key'
    assert all(re.fullmatch(r'\w+', key) for key in keys), f'{name}: {keys}'
    return Finished(
        name=name,
        title=case.title,
        section=section_of(name),
        checks=outcome.checks,
        pictures=tuple(pictures),
        tables=outcome.tables,
        text=outcome.text,
        seconds=seconds,
    )
