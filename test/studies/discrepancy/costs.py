"""Processor time of the blind tests: what each stage took of each trial, kept beside the trials."""

import json
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from time import process_time
from typing import Any

from trawl_ros.core.files import appending
from trawl_ros.lab.report.measured import MeasuredValue, at_least

COSTS = 'costs.jsonl'
MAKING = 'making trials'
"""Stage that each trial goes through once."""

PER_HOUR, CORES = 800.0, 2


@dataclass(frozen=True)
class Timed:
    """Function of a stage that gives the processor time (s) of its process for a task."""

    act: Callable[[Any], object]

    def __call__(self, task: Any) -> float:
        """Do the task."""
        begin = process_time()
        self.act(task)
        return process_time() - begin


def keep_cost(folder: Path, stage: str, name: str, seconds: float) -> None:
    """Add what a stage took of a trial to those in the folder."""
    with appending(folder / COSTS) as file:
        file.write(json.dumps({'stage': stage, 'name': name, 's': round(seconds, 3)}) + '\n')


def cost_rows(folder: Path) -> list[MeasuredValue]:
    """Trials per hour, from the processor time of all stages; none where nothing was kept."""
    if not (folder / COSTS).is_file():
        return []
    kept = [json.loads(line) for line in (folder / COSTS).read_text('utf-8').splitlines()]
    trials = sum(line['stage'] == MAKING for line in kept)
    if not trials:
        return []
    took: Counter[str] = Counter()
    for line in kept:
        took[line['stage']] += line['s']
    parts = ', '.join(f'{stage} {seconds / trials:.1f} s' for stage, seconds in took.items())
    return [
        MeasuredValue(
            f'trials per hour on {CORES} cores',
            CORES * 3600.0 * trials / took.total(),
            target=at_least(PER_HOUR),
            note=f'processor time of a trial, over {trials} trials: {parts}',
        )
    ]
