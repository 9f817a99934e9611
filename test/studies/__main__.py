"""``python -m studies NAME``, with ``test`` on the path: run one study."""

import sys
from importlib import import_module

from studies.harness import main
from trawl_ros.core.errors import TrawlError

NAMES = ('coverage', 'motion', 'onset', 'discrepancy', 'instruments')


def run(words: list[str]) -> None:
    """Run the study that the first word names with the other words as options."""
    if not words or words[0] not in NAMES:
        given = words[0] if words else 'none'
        raise SystemExit(f'NAME: found {given}, expected one of {", ".join(NAMES)}')
    try:
        main(import_module(f'studies.{words[0]}.study').STUDY, words[1:])
    except TrawlError as reason:
        raise SystemExit(f'Error: {reason}') from None


if __name__ == '__main__':
    run(sys.argv[1:])
