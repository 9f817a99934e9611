"""Study of onsets: trials in files of their own, so that it goes on where it was."""

import json
from dataclasses import dataclass
from pathlib import Path

from trawl_ros.core.files import made_folder, write_json
from trawl_ros.core.progress import OnProgress, WorkProgress
from trawl_ros.lab.studies.onset.known import KnownBy
from trawl_ros.lab.studies.onset.trial import OnsetTrial, make_trial

SEED = 2500
"""Of the study as it is reported; limits and errors were chosen by tows of other seeds."""


@dataclass(frozen=True)
class OnsetPlan:
    """Plan: gear, trials with an effect and without, minutes of each, seed, shard, whether each
    trial is drawn, and how its boards are known when the tow begins.
    """

    gear: str = 'kaifuha'
    trials: int = 18
    clean: int = 10
    minutes: float = 35.0
    seed: int = SEED
    shard: int = 1
    shards: int = 1
    pictures: bool = False
    known: KnownBy = 'draw'


def wanted_trials(plan: OnsetPlan) -> list[tuple[int, bool]]:
    """Number of each trial, and whether it is a clean one.

    A clean tow and one with an effect take turns, so that a study that was stopped has both.
    """
    return [
        (number, clean)
        for number in range(max(plan.trials, plan.clean))
        for clean, of in ((False, plan.trials), (True, plan.clean))
        if number < of
    ]


def own_trials(plan: OnsetPlan) -> list[tuple[int, bool]]:
    """Trials of a plan's shard; by turns again, so that none has those of one kind alone."""
    return [one for one in wanted_trials(plan) if sum(one) % plan.shards == plan.shard - 1]


def run_onset(plan: OnsetPlan, folder: Path, on_progress: OnProgress) -> list[OnsetTrial]:
    """Make the trials that are not there yet; return all that are there."""
    made_folder(folder)
    own = own_trials(plan)
    for done, (number, clean) in enumerate(own):
        path = _path(plan, folder, number, clean)
        if path.exists():
            continue
        on_progress(WorkProgress('trials', done, len(own), 'trials'))
        picture = path.with_suffix('.png') if plan.pictures else None
        trial = make_trial(plan.gear, plan.seed, number, plan.minutes, clean, picture, plan.known)
        write_json(path, trial.record(), indent=1)
    paths = (_path(plan, folder, number, clean) for number, clean in wanted_trials(plan))
    return [_read(path) for path in paths if path.exists()]


def _path(plan: OnsetPlan, folder: Path, number: int, clean: bool) -> Path:
    kind = ('clean' if clean else 'effect') + ('_known' if plan.known == 'tow' else '')
    return folder / f'trial_{plan.seed}_{kind}_{number:04d}.json'


def _read(path: Path) -> OnsetTrial:
    record = json.loads(path.read_text(encoding='utf-8'))
    return OnsetTrial(**{**record, 'alike': tuple(record['alike'])})
