"""Count the words of the pages that are written by hand.

``python test/tools/count_words.py`` prints a line for each page, and their sum. Reports, and tables
between comments such as ``<!-- keys GearRecord -->``, are drawn from the code and do not count.
"""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
DRAWN = re.compile(r'docs/(studies/|validation/|autotrawls/|benchmark|interface|promises)')
DRAWN_TABLE = re.compile(r'<!-- ([\w ]+) -->.*?<!-- /\1 -->', re.DOTALL)


def count_words() -> dict[str, int]:
    """Return the number of words of each page by hand."""
    pages = [ROOT / 'README.md', ROOT / 'CONTRIBUTING.md', *sorted((ROOT / 'docs').rglob('*.md'))]
    names = {page.relative_to(ROOT).as_posix(): page for page in pages}
    return {
        name: len(DRAWN_TABLE.sub('', page.read_text('utf-8')).split())
        for name, page in names.items()
        if not DRAWN.match(name)
    }


if __name__ == '__main__':
    counts = count_words()
    for name, words in counts.items():
        print(f'{words:6} {name}')
    print(f'{sum(counts.values()):6} in all')
