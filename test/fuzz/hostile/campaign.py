"""Campaigns: many inputs for a target in processes of their own, and what came of them."""

import json
import os
import subprocess
import sys
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from hostile.child import Job
from hostile.trial import KINDS, Kind

_PATH = str(Path(__file__).parents[1])


@dataclass
class Tally:
    """Of one target.

    Attributes
    ----------
    inputs
        How many were read.
    faults
        By kind.
    longest_s, peak_bytes
        Of the input that took most.
    told
        Of each fault, where its input is kept and what was raised.
    """

    inputs: int = 0
    faults: Counter[Kind] = field(default_factory=Counter)
    longest_s: float = 0.0
    peak_bytes: int = 0
    told: list[str] = field(default_factory=list)

    def take(self, outcome: dict[str, Any]) -> None:
        """Count one outcome."""
        self.inputs += 1
        self.longest_s = max(self.longest_s, outcome['took_s'])
        self.peak_bytes = max(self.peak_bytes, outcome['peak_bytes'])
        if fault := outcome['fault']:
            self.faults[fault['kind']] += 1
            self.told.append(f'{fault["kind"]}, kept in {outcome["kept"]}:\n{fault["told"]}')

    def add(self, other: 'Tally') -> None:
        """Count what another counted."""
        self.inputs += other.inputs
        self.faults.update(other.faults)
        self.longest_s = max(self.longest_s, other.longest_s)
        self.peak_bytes = max(self.peak_bytes, other.peak_bytes)
        self.told += other.told

    def record(self) -> dict[str, Any]:
        """As it stands in ``fuzz.json``."""
        return {
            'inputs': self.inputs,
            **{kind: self.faults[kind] for kind in KINDS},
            'longest_s': round(self.longest_s, 2),
            'peak_mb': round(self.peak_bytes / 1e6),
        }


def campaign(jobs: Sequence[Job]) -> dict[str, Tally]:
    """Give readers their inputs, in a process of their own; what came of it, by target."""
    tallies = {job.name: Tally() for job in jobs}
    with TemporaryDirectory() as folder:
        orders, outcomes = Path(folder, 'jobs.json'), Path(folder, 'outcomes.jsonl')
        orders.write_text(json.dumps([asdict(job) for job in jobs]))
        done = subprocess.run(
            [sys.executable, '-m', 'hostile.child', str(orders), str(outcomes)],
            env={**os.environ, 'PYTHONPATH': _PATH, 'TMPDIR': folder},
            capture_output=True,
            text=True,
            errors='replace',
        )
        if done.returncode:
            raise RuntimeError(f'the process that does the jobs ended: {done.stderr[-2000:]}')
        for line in outcomes.read_text().splitlines():
            record = json.loads(line)
            tallies[record['target']].take(record)
    return tallies
