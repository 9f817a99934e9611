"""Trials of a study: their tasks, and the files of those done, from which it resumes."""

import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

import numpy as np

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import appending, empty_folder, write_json, write_text
from trawl_ros.core.parallel import run_tasks
from trawl_ros.core.progress import OnProgress, ignore, step_counter

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

    class KeptTrial(DataclassInstance, Protocol):
        """Record of a trial, of plain values."""

        @property
        def series(self) -> str:
            """Series that it belongs to."""
            ...

        @property
        def number(self) -> int:
            """Number within the series."""
            ...


TrialT = TypeVar('TrialT', bound='KeptTrial')
TaskT = TypeVar('TaskT', bound='TrialTask')


@dataclass(frozen=True)
class TrialTask:
    """Task of one trial.

    Attributes
    ----------
    series
        The series it belongs to, which is part of the seed.
    number
        Within the series.
    seed
        Of the study.
    gear
        File or name.
    """

    series: str
    number: int
    seed: int
    gear: str

    @property
    def name(self) -> str:
        """Name in files and sentences."""
        return f'{self.series} {self.number}'

    def rng(self) -> np.random.Generator:
        """Random generator of this trial alone, wherever and whenever it is made."""
        return np.random.default_rng([self.seed, self.number, *self.series.encode()])


class KeptTrials(Generic[TrialT]):
    """Files with a line per trial; the first line has the settings common to all of them.

    Each shard writes its own file, and all files of the folder are read.

    Parameters
    ----------
    folder
        Folder of the files.
    asked
        Settings on which each trial depends; plain values.
    kind
        Record of a trial.
    shard
        Number of this shard, and of all shards.
    force
        True to replace files of other settings, and to begin again with the same.

    Raises
    ------
    TrawlError
        If a file has other settings or no trials, or the folder holds other files alone.
    """

    def __init__(
        self,
        folder: Path,
        asked: Mapping[str, object],
        kind: type[TrialT],
        *,
        shard: tuple[int, int] = (1, 1),
        force: bool = False,
    ) -> None:
        self._kind, self._shard = kind, shard
        self._asked = json.loads(json.dumps(asked))
        self._trials: dict[tuple[str, int], TrialT] = {}
        part, parts = shard
        self.path = folder / ('trials.jsonl' if parts == 1 else f'trials_{part}_of_{parts}.jsonl')
        known = sorted(folder.glob('trials*.jsonl'))
        if force or not known:
            empty_folder(folder, force=force)
            folder.mkdir(parents=True, exist_ok=True)
            for path in known:
                path.unlink()
        else:
            for path in known:
                self._read(path)
        if not self.path.is_file():
            write_json(self.path, {'asked': self._asked})

    def _read(self, path: Path) -> None:
        first, *lines = path.read_text(encoding='utf-8').split('\n')
        try:
            asked = json.loads(first)['asked']
        except (ValueError, KeyError, TypeError) as reason:
            raise TrawlError(
                f'{path}: not a file of trials, expected one, none, or --force'
            ) from reason
        if asked != self._asked:
            raise TrawlError(
                f'{path}: has trials made with {_words(asked, self._asked)}, expected '
                f'{_words(self._asked, asked)}, another folder, or --force'
            )
        whole = [line for line in lines[:-1] if line]
        for number, line in enumerate(whole, 2):
            try:
                trial = self._kind(**json.loads(line))
            except (ValueError, TypeError) as reason:
                raise TrawlError(
                    f'{path}: line {number} is not a trial, expected one, or --force'
                ) from reason
            self._trials[trial.series, trial.number] = trial
        if lines and lines[-1] and path == self.path:
            # A study that was killed may leave a line without its end.
            write_text(path, '\n'.join((first, *whole)) + '\n')

    def run_missing(
        self,
        run: Callable[[TaskT], TrialT],
        tasks: Iterable[TaskT],
        on_progress: OnProgress = ignore,
        *,
        scheduler: str | None = None,
        workers: int | None = None,
    ) -> None:
        """Run this shard's tasks whose trials are not there, and keep each as it ends.

        ``run`` is a function of a module, which runs in other processes; scheduler and workers are
        as in `trawl_ros.core.parallel.run_tasks`.
        """
        part, parts = self._shard
        own = [task for task in tasks if task.number % parts == part - 1]
        missing = {task.name: task for task in own if not self.has(task.series, task.number)}
        done = step_counter('trials', len(missing), on_progress)
        for _, trial in run_tasks(run, missing, scheduler=scheduler, workers=workers):
            self.add(trial)
            done()

    def add(self, trial: TrialT) -> None:
        """Append a trial."""
        with appending(self.path) as file:
            file.write(json.dumps(asdict(trial), allow_nan=False) + '\n')
        self._trials[trial.series, trial.number] = trial

    def has(self, series: str, number: int) -> bool:
        """True if a trial is there already."""
        return (series, number) in self._trials

    def series(self, series: str) -> tuple[TrialT, ...]:
        """Trials of a series in the order of their numbers."""
        found = sorted(key for key in self._trials if key[0] == series)
        return tuple(self._trials[key] for key in found)


def _words(asked: Mapping[str, Any], other: Mapping[str, Any]) -> str:
    different = [key for key in asked if asked[key] != other.get(key)]
    # Of a gear it is enough to know that it is another one.
    short = {key: value for key, value in asked.items() if not isinstance(value, Mapping)}
    return ', '.join(
        f'{key} {short[key]}' if key in short else f'another {key}' for key in different
    )
