"""Campaign over all targets for so many minutes: `make fuzz`."""

import argparse
import json
import secrets
import subprocess
import sys
import time
from importlib.metadata import version
from pathlib import Path

from hostile.campaign import Tally, campaign
from hostile.child import Job
from hostile.registry import TARGETS
from hostile.trial import KINDS, LONGEST_S, MOST_BYTES

_BATCH = 500
"""Inputs per process: few enough that one that grows is seen, many enough to start seldom."""


def main() -> None:
    """Run the campaign; 1 if anything was found."""
    options = _options()
    until = time.monotonic() + 60 * options.minutes
    keep = str(options.keep / str(options.seed))
    left = dict.fromkeys(options.targets or TARGETS, options.inputs)
    tallies = {name: Tally() for name in left}
    seed, replay = options.seed, True
    while left and (remaining := until - time.monotonic()) > 0:
        share = max(5.0, remaining / len(left))
        jobs = [
            Job(name, seed, min(_BATCH, wanted), share, replay, keep)
            for name, wanted in left.items()
        ]
        for job in jobs if time.monotonic() < until else ():
            tally = campaign([job])[job.name]
            tallies[job.name].add(tally)
            left[job.name] -= max(tally.inputs, 1)
            _say(job.name, tallies[job.name])
        left = {name: wanted for name, wanted in left.items() if wanted > 0}
        seed, replay = seed + 1000, False
    record = _record(tallies, options.seed)
    text = json.dumps(record, indent=1)
    print(text)
    for tally in tallies.values():
        for told in tally.told:
            print(told, file=sys.stderr)
    if options.out:
        options.out.write_text(text + '\n')
    sys.exit(any(record['total'][kind] for kind in KINDS))


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('targets', nargs='*', help='All by default.')
    parser.add_argument('--minutes', type=float, default=60.0)
    parser.add_argument('--inputs', type=int, default=10**9, help='Per target, at most.')
    parser.add_argument('--seed', type=int, default=secrets.randbelow(10**9))
    parser.add_argument('--out', type=Path, help='File for the result.')
    parser.add_argument('--keep', type=Path, default=Path('out/fuzz'), help='Inputs that broke.')
    options = parser.parse_args()
    if unknown := set(options.targets) - TARGETS.keys():
        parser.error(f'unknown: {", ".join(sorted(unknown))}; expected {", ".join(TARGETS)}')
    return options


def _say(name: str, tally: Tally) -> None:
    found = ', '.join(f'{tally.faults[kind]} {kind}' for kind in KINDS)
    print(f'{name}: {tally.inputs} inputs, {found}', file=sys.stderr, flush=True)


def _record(tallies: dict[str, Tally], seed: int) -> dict[str, object]:
    total = Tally()
    for tally in tallies.values():
        total.add(tally)
    commit = subprocess.run(
        ['git', 'rev-parse', '--short', 'HEAD'], capture_output=True, text=True, check=False
    )
    return {
        'version': version('trawl_ros'),
        'commit': commit.stdout.strip(),
        'hypothesis': version('hypothesis'),
        'seed': seed,
        'limits': {'longest_s': LONGEST_S, 'most_mb': round(MOST_BYTES / 1e6)},
        'total': total.record(),
        'targets': {name: tally.record() for name, tally in tallies.items()},
    }


if __name__ == '__main__':
    main()
