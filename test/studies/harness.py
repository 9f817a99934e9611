"""Harness of all studies: options from a plan, trials in shards, resuming, rows, and the page."""

import argparse
import json
import math
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import Field, dataclass, field, fields
from pathlib import Path
from typing import Any, Generic, TypeVar

from studies.kept import KeptTrials, TaskT, TrialT
from trawl_ros.cli.console.progress import error_console
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.progress import OnProgress, ignore
from trawl_ros.lab.commands.outcome import print_missed, print_reached, stoppable
from trawl_ros.lab.report.machine import cpu_model, software
from trawl_ros.lab.report.measured import MeasuredValue, TargetRange, at_least, at_most, between
from trawl_ros.lab.report.page import Page, Section, write_page
from trawl_ros.report.pictures import Drawing

PlanT = TypeVar('PlanT')

OUT = Path('out/studies')
"""Folder that holds a folder for each study, where no other is named."""


def option(default: Any, words: str, **more: object) -> Any:
    """Return a field of a plan, which becomes an option of the command with a sentence of help."""
    return field(default=default, metadata={'help': words, **more})


@dataclass(frozen=True)
class Work:
    """How a study is run.

    Attributes
    ----------
    folder
        Takes the trials, logs and the report.
    on_progress
        Called after each trial and each part of the rest.
    scheduler, workers
        As in `trawl_ros.core.parallel.run_tasks`.
    shard
        Number of this shard of the trials, and of all shards.
    force
        True to begin again.
    """

    folder: Path
    on_progress: OnProgress = ignore
    scheduler: str | None = None
    workers: int | None = None
    shard: tuple[int, int] = (1, 1)
    force: bool = False

    def trials(
        self,
        asked: Mapping[str, object],
        kind: type[TrialT],
        run: Callable[[TaskT], TrialT],
        tasks: Iterable[TaskT],
    ) -> KeptTrials[TrialT]:
        """Run the trials that the folder lacks; return all that are there.

        Raises
        ------
        TrawlError
            If trials of other settings are kept there, or one cannot be made.
        """
        kept = KeptTrials(self.folder, asked, kind, shard=self.shard, force=self.force)
        kept.run_missing(
            run, tasks, self.on_progress, scheduler=self.scheduler, workers=self.workers
        )
        return kept


@dataclass(frozen=True)
class StudyResult:
    """Sections and drawings of the page, and what the JSON file has besides the rows."""

    sections: Sequence[Section]
    drawings: Sequence[Drawing] = ()
    record: Mapping[str, object] = field(default_factory=dict)


@dataclass(frozen=True)
class Study(Generic[PlanT]):
    """Study.

    Attributes
    ----------
    name, page, title
        Name on the command line, of its files, and its heading.
    plan
        Frozen dataclass of options, each made by `option`.
    quick
        Values of the plan with which the study takes minutes.
    run, method
        Make the result; say in sentences how it is made.
    """

    name: str
    page: str
    title: str
    plan: type[PlanT]
    quick: Mapping[str, object]
    run: Callable[[PlanT, Work], StudyResult]
    method: Callable[[PlanT], str]

    def command(self, plan: PlanT) -> str:
        """Return the command that makes the same report again."""
        words = []
        for own in fields(self.plan):  # type: ignore[arg-type]
            value = getattr(plan, own.name)
            if value != own.default:
                flag = f'--{own.name.replace("_", "-")}'
                words.append(flag if value is True else f'{flag} {value}')
        return f'make study NAME={self.name}' + (f" ARGS='{' '.join(words)}'" if words else '')


def machine_words() -> str:
    """Return a sentence on the machine and the software."""
    versions = ', '.join(f'{name} {version}' for name, version in software().items())
    return f'On {os.cpu_count()} cores of {cpu_model()}, with {versions}.'


def run_study(study: Study[PlanT], plan: PlanT, work: Work) -> list[MeasuredValue]:
    """Run a study and write its page; return all rows."""
    result = study.run(plan, work)
    page = Page(study.page, study.title, study.command(plan), study.method(plan))
    return write_study(work.folder, page, result)


def write_study(folder: Path, page: Page, result: StudyResult) -> list[MeasuredValue]:
    """Write ``<page>.json``, ``.md``, ``.html`` and pictures; each row with its section."""
    rows = [
        {'section': section.title, **row.record()}
        for section in result.sections
        for row in section.rows
    ]
    record = {'rows': rows, **result.record}
    return write_page(folder, page, result.sections, result.drawings, record=record)


def render(study: Study[PlanT], rows: Path, folder: Path) -> list[MeasuredValue]:
    """Write the page again from the rows of an earlier run, without its tables and pictures."""
    record = json.loads(rows.read_text(encoding='utf-8'))
    by_section: dict[str, list[MeasuredValue]] = {}
    for row in record['rows']:
        by_section.setdefault(row.get('section', 'Values'), []).append(read_row(row))
    sections = [Section(title, own) for title, own in by_section.items()]
    others = {key: value for key, value in record.items() if key != 'rows'}
    page = Page(
        study.page, study.title, f'{study.command(study.plan())} --rows {rows}',
        'Rows of an earlier run; tables and pictures need the run itself.',
    )  # fmt: skip
    return write_study(folder, page, StudyResult(sections, record=others))


def read_row(record: Mapping[str, Any]) -> MeasuredValue:
    """Read a row of a JSON file.

    Raises
    ------
    TrawlError
        If its value reaches the target, and the file says otherwise, or the other way round.
    """
    value, low, high = (
        math.nan if record[name] is None else float(record[name])
        for name in ('value', 'low', 'high')
    )
    row = MeasuredValue(
        record['what'], value, record['unit'], _target(record['target']), record['note'], low, high
    )
    if row.ok != record['ok']:
        raise TrawlError(f'{row.what}: found ok {record["ok"]}, expected {row.ok} for {row.figure}')
    return row


def _target(ends: Any) -> TargetRange | None:
    match ends:
        case None:
            return None
        case [low, None]:
            return at_least(low)
        case [low, high]:
            return between(low, high)
        case _:
            return at_most(ends)


def parser(study: Study[PlanT]) -> argparse.ArgumentParser:
    """Return the parser of a study's options."""
    found = argparse.ArgumentParser(f'make study NAME={study.name}', description=study.title)
    for own in fields(study.plan):  # type: ignore[arg-type]
        _add_option(found, own)
    found.add_argument('--out', type=Path, default=OUT / study.name, help='Folder of the report.')
    found.add_argument('--force', action='store_true', help='Begin again, whatever is there.')
    found.add_argument('--quick', action='store_true', help='Few trials, in minutes.')
    found.add_argument('--scheduler', help='Address of a Dask cluster that shares the work.')
    found.add_argument('--workers', type=int, help='Processes of this machine.')
    found.add_argument('--shard', type=int, nargs=2, default=(1, 1), metavar=('PART', 'OF'),
                       help='Make one part of the trials alone.')  # fmt: skip
    found.add_argument('--rows', type=Path, help='Instead: write the page from these rows (JSON).')
    return found


def _add_option(to: argparse.ArgumentParser, own: 'Field[Any]') -> None:
    flag, words = f'--{own.name.replace("_", "-")}', own.metadata['help']
    if own.default is False:
        to.add_argument(flag, action='store_true', default=None, help=words)
        return
    kind = own.metadata.get('type', type(own.default))
    choices = own.metadata.get('choices')
    to.add_argument(flag, type=kind, choices=choices, help=f'{words} ({own.default})')


def main(study: Study[PlanT], words: Sequence[str]) -> None:
    """Run a study from the command line; Ctrl-C keeps the trials made so far."""
    given = parser(study).parse_args(words)
    if given.rows is not None:
        _print(render(study, given.rows, given.out), given.out / f'{study.page}.md')
        return
    own = {
        name: value
        for name in study.plan.__dataclass_fields__  # type: ignore[attr-defined]
        if (value := getattr(given, name)) is not None
    }
    plan = study.plan(**{**(study.quick if given.quick else {}), **own})
    shard = (given.shard[0], given.shard[1])
    with stoppable(f'the trials made so far are kept in {given.out}') as (display, _):
        work = Work(given.out, display, given.scheduler, given.workers, shard, given.force)
        rows = run_study(study, plan, work)
    _print(rows, given.out / f'{study.page}.md')


def _print(rows: Sequence[MeasuredValue], report: Path) -> None:
    print_missed(rows, error_console())
    print_reached(rows, report)
