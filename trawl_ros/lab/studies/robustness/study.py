"""Study of robustness: trials in shards, each kept in a file from which the study resumes."""

import json
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Literal

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import appending, made_folder, write_text
from trawl_ros.core.progress import OnProgress, WorkProgress
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.studies.robustness.changed_values import numbers, tow_outcome
from trawl_ros.lab.studies.robustness.random_commands import commanded_hour
from trawl_ros.model.gear_model import build_model

LENGTHS = 500.0, 300.0, 700.0
"""Warp lengths of tows with a changed value, m."""

FACTORS = 0.8, 1.2

Part = Literal['values', 'commands']


@dataclass(frozen=True)
class RobustnessPlan:
    """Plan: gear, meshes around its net, hours of random commands, warp lengths of changed gears;
    the shard of the trials that is made here, of how many, and the time (s) given to it.
    """

    gear: str = 'kaifuha'
    around: int = 24
    hours: int = 100
    lengths: tuple[float, ...] = LENGTHS
    shard: int = 1
    shards: int = 1
    seconds: float = 3600.0


@dataclass(frozen=True)
class RobustnessTrial:
    """Trial: its part and name, the outcome in a word and a sentence, and CPU time (s);
    ``fallen_s`` and ``fallen_at_end`` are of an hour of commands.
    """

    part: Part
    name: str
    around: int
    outcome: str
    sentence: str
    seconds: float
    fallen_s: float = 0.0
    fallen_at_end: bool = False


def run_robustness(
    plan: RobustnessPlan, folder: Path, on_progress: OnProgress
) -> list[RobustnessTrial]:
    """Make the trials of a shard that are not kept yet, and return those of all shards.

    Raises
    ------
    TrawlError
        If the folder cannot be used, or a file in it is none of trials.
    """
    made_folder(folder)
    gear = load_gear(plan.gear)
    netting = gear.netting.model_copy(update={'around': plan.around})
    gear = gear.model_copy(update={'netting': netting})
    done = {trial.name for trial in kept(folder) if trial.around == plan.around}
    names = [name for k, name in enumerate(_names(plan, gear)) if k % plan.shards == plan.shard - 1]
    if set(names) - done:
        # Compiling at first use is no time of a trial.
        tow_outcome(gear, next(numbers(gear)), 1.0, LENGTHS[0])
    began = time.monotonic()
    file = folder / f'trials_{plan.shard}_of_{plan.shards}.jsonl'
    if file.is_file() and not (text := file.read_text(encoding='utf-8')).endswith('\n'):
        # A study that was killed may leave a line without its end.
        write_text(file, text[: text.rfind('\n') + 1])
    for number, name in enumerate(names):
        if time.monotonic() - began > plan.seconds:
            break
        if name in done:
            continue
        on_progress(WorkProgress('trials', number, len(names), 'trials', name))
        trial = _trial(plan, gear, name)
        with appending(file) as lines:
            lines.write(json.dumps(asdict(trial)) + '\n')
    return kept(folder)


def kept(folder: Path) -> list[RobustnessTrial]:
    """Return the trials kept in a folder, of all shards."""
    trials = []
    for path in sorted(folder.glob('trials_*.jsonl')):
        # Text behind the last end of a line is a trial cut short.
        for number, line in enumerate(path.read_text(encoding='utf-8').split('\n')[:-1], 1):
            try:
                trials.append(RobustnessTrial(**json.loads(line)))
            except (ValueError, TypeError) as reason:
                raise TrawlError(
                    f'{path}: line {number} is not a trial, expected one, or another folder'
                ) from reason
    return trials


def _names(plan: RobustnessPlan, gear: GearRecord) -> Iterator[str]:
    """Names of all trials: ``KEY*FACTOR at LENGTH`` and ``hour SEED``."""
    for length in plan.lengths:
        for key in numbers(gear):
            for factor in FACTORS:
                yield f'{key} * {factor:g} at {length:g}'
    for seed in range(plan.hours):
        yield f'hour {seed}'


def _trial(plan: RobustnessPlan, gear: GearRecord, name: str) -> RobustnessTrial:
    began = time.process_time()
    if name.startswith('hour '):
        hour = commanded_hour(build_model(gear), int(name.split()[1]))
        return RobustnessTrial(
            'commands',
            name,
            plan.around,
            'failed' if hour.failure else 'towed',
            hour.failure,
            time.process_time() - began,
            hour.fallen_s,
            hour.fallen_at_end,
        )
    key, _, factor, _, length = name.split()
    outcome, sentence = tow_outcome(gear, key, float(factor), float(length))
    seconds = time.process_time() - began
    return RobustnessTrial('values', name, plan.around, outcome, sentence, seconds)
