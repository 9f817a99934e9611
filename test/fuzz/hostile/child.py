"""A process that gives readers many inputs, each reader in a fork within limits, a line for each.

Run as ``python -m hostile.child JOBS OUTCOMES``: files of a JSON list of jobs and of JSON lines.
"""

import json
import os
import resource
import sys
import time
import traceback
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from hypothesis import HealthCheck, Phase, given, seed, settings

from hostile.registry import TARGETS, known
from hostile.target import Files
from hostile.trial import MOST_BYTES, Fault, Outcome, attempt


@dataclass(frozen=True)
class Job:
    """What a target is to be given.

    Attributes
    ----------
    name
        Of the target.
    seed, inputs
        Of new inputs: the seed, and how many.
    seconds
        After which no more are given.
    replay
        Whether the inputs that once broke it come first.
    keep
        Folder for inputs that break it.
    """

    name: str
    seed: int
    inputs: int
    seconds: float
    replay: bool
    keep: str


def main() -> None:
    """Do the jobs one after the other; where a fork dies, the next goes on with the next seed."""
    jobs, outcomes = sys.argv[1:]
    for job in [Job(**record) for record in json.loads(Path(jobs).read_text())]:
        with TemporaryDirectory() as folder:
            wanted = job
            while (given := _fork(wanted, Path(folder), Path(outcomes))) is not None:
                wanted = replace(
                    wanted, seed=wanted.seed + 1, inputs=wanted.inputs - given, replay=False
                )


def _fork(job: Job, place: Path, outcomes: Path) -> int | None:
    """Do a job in a fork; None if it lived, else how many inputs it was given."""
    pid = os.fork()
    if pid == 0:
        with (place / 'stderr').open('wb') as stderr:
            os.dup2(stderr.fileno(), 2)
        code = 1
        try:
            _work(job, place, outcomes)
            code = 0
        except BaseException:
            traceback.print_exc()
        finally:
            sys.stderr.flush()
            os._exit(code)
    _, status = os.waitpid(pid, 0)
    if status == 0:
        return None
    told = (place / 'stderr').read_text(errors='replace')[-2000:]
    fault = Fault('hang' if 'Timeout (' in told else 'crash', f'wait status {status}: {told}')
    label, given = (place / 'label').read_text().split()
    _note(job, place, outcomes, label, Outcome(fault, 0.0, 0))
    return int(given)


def _work(job: Job, place: Path, outcomes: Path) -> None:
    target = TARGETS[job.name]
    # Address space is not memory: the guard is double what a reader may take.
    taken = int(Path('/proc/self/statm').read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (taken + 2 * MOST_BYTES, resource.RLIM_INFINITY))
    until = time.monotonic() + job.seconds
    given_new = 0

    def give(files: Files, label: str) -> None:
        label = f'{job.name}-{label}'
        (place / 'label').write_text(f'{label} {given_new}')
        _note(job, place, outcomes, label, attempt(target.read, files, place / 'trial'))

    if job.replay:
        for what, files in known(target).items():
            give(files, what)

    @seed(job.seed)
    @settings(
        max_examples=job.inputs,
        database=None,
        deadline=None,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(target.inputs)
    def generate(files: Files) -> None:
        nonlocal given_new
        if time.monotonic() < until:
            given_new += 1
            give(files, f'{job.seed}-{given_new}')

    if job.inputs > 0:
        generate()


def _note(job: Job, place: Path, outcomes: Path, label: str, outcome: Outcome) -> None:
    kept = None
    if outcome.fault:
        kept = Path(job.keep) / label
        kept.parent.mkdir(parents=True, exist_ok=True)
        (place / 'trial' / 'input').rename(kept)
    record = {'target': job.name, 'label': label, 'kept': str(kept), **asdict(outcome)}
    with outcomes.open('a', encoding='utf-8') as lines:
        lines.write(json.dumps(record) + '\n')


if __name__ == '__main__':
    main()
