"""Trials of a study: their tasks, and the file of those done, from which it resumes."""

import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

import numpy as np

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import appending, empty_folder, write_json, write_text
from trawl_ros.core.progress import OnProgress, ignore, step_counter
from trawl_ros.lab.studies.identification.plant import Cut

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

FILE = 'trials.jsonl'


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
    cut
        Meshes of model and plant.
    """

    series: str
    number: int
    seed: int
    gear: str
    cut: Cut

    @property
    def name(self) -> str:
        """Name in files and sentences."""
        return f'{self.series} {self.number}'

    def chance(self) -> np.random.Generator:
        """Random generator of this trial alone, wherever and whenever it is made."""
        return np.random.default_rng([self.seed, self.number, *self.series.encode()])


class KeptTrials(Generic[TrialT]):
    """File with a line per trial, and the common settings of all of them in its first line.

    Parameters
    ----------
    folder
        Folder of the file.
    asked
        Settings on which each trial depends; plain values.
    kind
        Record of a trial.
    force
        True if a file of other settings is written over, and one of the same begun anew.

    Raises
    ------
    TrawlError
        If the file is of other settings, or is none of trials, or there is none in a folder of
        other files.
    """

    def __init__(
        self, folder: Path, asked: Mapping[str, object], kind: type[TrialT], *, force: bool = False
    ) -> None:
        self._path, self._kind = folder / FILE, kind
        self._asked = json.loads(json.dumps(asked))
        self._trials: dict[tuple[str, int], TrialT] = {}
        if force or not self._path.is_file():
            empty_folder(folder, force=force)
            folder.mkdir(parents=True, exist_ok=True)
            write_json(self._path, {'asked': self._asked})
            return
        self._read()

    def _read(self) -> None:
        first, *lines = self._path.read_text(encoding='utf-8').split('\n')
        try:
            asked = json.loads(first)['asked']
        except (ValueError, KeyError, TypeError) as reason:
            raise TrawlError(
                f'{self._path}: not a file of trials, expected one, none, or --force'
            ) from reason
        if asked != self._asked:
            raise TrawlError(
                f'{self._path}: has trials made with {_words(asked, self._asked)}, expected '
                f'{_words(self._asked, asked)}, another folder, or --force'
            )
        whole = [line for line in lines[:-1] if line]
        for number, line in enumerate(whole, 2):
            try:
                trial = self._kind(**json.loads(line))
            except (ValueError, TypeError) as reason:
                raise TrawlError(
                    f'{self._path}: line {number} is not a trial, expected one, or --force'
                ) from reason
            self._trials[trial.series, trial.number] = trial
        if lines and lines[-1]:
            # A study that was killed may leave a line without its end.
            kept = '\n'.join((first, *whole)) + '\n'
            write_text(self._path, kept)

    def run_missing(
        self,
        run: Callable[[TaskT], TrialT],
        tasks: Iterable[TaskT],
        on_progress: OnProgress = ignore,
        *,
        scheduler: str | None = None,
        workers: int | None = None,
    ) -> None:
        """Run the tasks whose trials are not there, and keep each as it ends.

        Parameters
        ----------
        run
            Function of a module, which runs in other processes.
        tasks
            Of all trials that are wanted.
        on_progress
            Called after each trial.
        scheduler, workers
            As in `trawl_ros.core.parallel.run_tasks`.
        """
        # Dask takes a second to import, for which other commands need not wait.
        from trawl_ros.core.parallel import run_tasks

        missing = {task.name: task for task in tasks if not self.has(task.series, task.number)}
        done = step_counter('trials', len(missing), on_progress)
        for _, trial in run_tasks(run, missing, scheduler=scheduler, workers=workers):
            self.add(trial)
            done()

    def add(self, trial: TrialT) -> None:
        """Append a trial."""
        with appending(self._path) as file:
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
