"""Coverage-guided campaign on one target, by atheris: it keeps inputs that reach new lines.

Run as ``PYTHONPATH=test/fuzz python -m hostile.guided TARGET --minutes 5``, with
``pip install atheris`` before, which has no builds for some Pythons.
"""

import argparse
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import atheris
from hypothesis import HealthCheck, given, settings

# Before the rest: numba cannot compile what is instrumented.
import trawl_ros.estimation.from_gear  # noqa: F401

with atheris.instrument_imports(include=['trawl_ros', 'mcap']):
    from hostile.registry import TARGETS
    from hostile.target import Files
    from hostile.trial import MOST_BYTES, attempt


def main() -> None:
    """Run the campaign; it ends with the first input that breaks the reader."""
    options = _options()
    target = TARGETS[options.target]
    options.corpus.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory() as folder:

        @settings(database=None, deadline=None, suppress_health_check=list(HealthCheck))
        @given(target.inputs)
        def give(files: Files) -> None:
            fault = attempt(target.read, files, Path(folder, 'trial')).fault
            assert fault is None, fault.told

        limits = (
            f'-max_total_time={60.0 * options.minutes:.0f}',
            f'-rss_limit_mb={2 * MOST_BYTES // 10**6}',
            f'-artifact_prefix={options.corpus}/broke-',
            '-max_len=65536',
            '-len_control=0',
        )
        atheris.Setup([sys.argv[0], str(options.corpus), *limits], give.hypothesis.fuzz_one_input)
        atheris.Fuzz()


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('target', choices=sorted(TARGETS))
    parser.add_argument('--minutes', type=float, default=5.0)
    parser.add_argument('--corpus', type=Path, default=Path('out/guided'), help='Inputs to keep.')
    return parser.parse_args()


if __name__ == '__main__':
    main()
