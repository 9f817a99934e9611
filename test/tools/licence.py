"""Name the licence at the head of each file of the package: `python test/tools/licence.py`."""

from pathlib import Path

ROOT = Path(__file__).parents[2]
HEADER = '# Copyright the trawl_ros developers\n# SPDX-License-Identifier: Apache-2.0\n'


def files() -> list[Path]:
    """Files of the package that hold Python."""
    folders = [ROOT / name for name in ('trawl_ros', 'launch')]
    return [ROOT / 'setup.py', *sorted(path for one in folders for path in one.rglob('*.py'))]


def without() -> list[Path]:
    """Files that do not begin with the header."""
    return [path for path in files() if not path.read_text(encoding='utf-8').startswith(HEADER)]


if __name__ == '__main__':
    for path in without():
        path.write_text(HEADER + path.read_text(encoding='utf-8'), encoding='utf-8')
