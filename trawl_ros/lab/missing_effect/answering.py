# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Answers of the methods of the project to a folder of trials."""

import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TypeVar

from trawl_ros.core.files import made_folder, write_json
from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
from trawl_ros.diagnosis.diagnosis import Diagnosis
from trawl_ros.diagnosis.procedure import diagnose_windows
from trawl_ros.lab.missing_effect.baselines import (
    BaselineOptions,
    bic,
    clean_regime,
    gaussian_process,
    largest_residual,
    sparse_regression,
)
from trawl_ros.lab.missing_effect.prepared import Prepared, answer, prepare, with_repair
from trawl_ros.lab.missing_effect.records import AnswerRecord, AnswersRecord
from trawl_ros.lab.missing_effect.trials_folder import (
    TrialInput,
    read_answers,
    read_input,
    read_trials,
)

Baseline = Callable[[Prepared, BaselineOptions], AnswerRecord]

ResultT = TypeVar('ResultT')

OURS = 'trawl_diagnose'
BASELINES: Mapping[str, Baseline] = {
    own.__name__: own
    for own in (largest_residual, bic, clean_regime, sparse_regression, gaussian_process)
}
METHODS = (OURS, *BASELINES)


def answer_trials(
    folder: Path,
    out: Path,
    methods: Sequence[str] = METHODS,
    on_progress: OnProgress = ignore,
) -> None:
    """Answer all trials with some methods, or go on where an earlier call ended.

    Parameters
    ----------
    folder
        Folder of the trials.
    out
        Folder of the answers: a file for each method, written after each trial.
    methods
        Names of methods.
    on_progress
        Called before each trial.

    Raises
    ------
    TrawlError
        If data or earlier answers cannot be read, or answers cannot be written.
    """
    trials = read_trials(folder)
    made_folder(out)
    files = {name: out / f'{name}.json' for name in methods}
    answers = {
        name: read_answers(path, trials, complete=False)
        if path.exists()
        else AnswersRecord(method=name, trials={})
        for name, path in files.items()
    }
    for done, trial in enumerate(trials.trials):
        on_progress(WorkProgress('answering', done, len(trials.trials), 'trials', trial.name))
        waiting = [name for name in methods if trial.name not in answers[name].trials]
        if not waiting:
            continue
        data = read_input(folder, trial, trials.form)
        ready = prepare(data) if any(name in BASELINES for name in waiting) else None
        for name in waiting:
            answers[name].trials[trial.name] = answer_trial(name, data, ready)
            write_json(files[name], answers[name].model_dump(mode='json', exclude_none=True))


def trawl_diagnose(data: TrialInput) -> AnswerRecord:
    """Diagnose a trial in the same way as `trawl diagnose`."""
    return answer_of(diagnose_windows(data.gear, data.windows, data.tows, data.baseline))


def answer_of(found: Diagnosis) -> AnswerRecord:
    """Return a diagnosis as an answer."""
    if found.posterior is None:
        return AnswerRecord(verdict='NOT_TESTABLE')
    # A frozen sensor is named without a place in the library: no trial hides one.
    verdict = 'UNKNOWN' if found.verdict == 'NAMED' and not found.named else found.verdict
    made = answer(found.posterior, verdict, found.named, found.among, found.best)
    if found.repair is None or found.repair.refit is None or found.base is None:
        return made
    return with_repair(made, found.holdout, found.base, found.repair.refit)


def answer_trial(name: str, data: TrialInput, ready: Prepared | None) -> AnswerRecord:
    """Answer one trial with a method, and measure its processor time.

    The time of a baseline contains the fit and the screen that all baselines share.
    """

    def own() -> AnswerRecord:
        if name == OURS:
            return trawl_diagnose(data)
        if ready is None:
            return AnswerRecord(verdict='NOT_TESTABLE')
        return BASELINES[name](ready, BaselineOptions())

    made, seconds = timed(own)
    shared = ready.seconds if ready is not None and name in BASELINES else 0.0
    return made.model_copy(update={'seconds': shared + seconds})


def timed(work: Callable[[], ResultT]) -> tuple[ResultT, float]:
    """Return a result, and the processor time (s) that it took."""
    begun = time.process_time()
    return work(), time.process_time() - begun
