"""Table of docs/design.md, drawn from the contract in pyproject.toml and from the packages."""

import ast
import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]
DESIGN = ROOT / 'docs' / 'design.md'
PACKAGE = ROOT / 'trawl_ros'


def contracts() -> dict[str, dict[str, object]]:
    """The contracts by their id."""
    settings = tomllib.loads((ROOT / 'pyproject.toml').read_text(encoding='utf-8'))
    return {contract['id']: contract for contract in settings['tool']['importlinter']['contracts']}


def floors() -> list[list[str]]:
    """Folders of each layer, the highest first."""
    rows = [re.findall(r'\w+', row) for row in contracts()['layers']['layers']]
    rows = [[name for name in row if (PACKAGE / name).is_dir()] for row in rows]
    return [row for row in rows if row]


def sentence(folder: Path) -> str:
    """First line of a package's docstring."""
    text = (folder / '__init__.py').read_text(encoding='utf-8')
    return (ast.get_docstring(ast.parse(text)) or '').partition('\n')[0]


def floors_table() -> str:
    """Layers with their folders and what is in them."""
    rows = [
        f'| {number} | `{name}/` | {sentence(PACKAGE / name)} |'
        for number, row in zip(range(len(floors()), 0, -1), floors())
        for name in row
    ]
    return '\n'.join(['| layer | folder | what is in it |', '|---|---|---|', *rows])


def drawn(text: str) -> str:
    """The document with its table as it should be."""
    before, _, rest = text.partition('<!-- floors -->')
    _, foot, after = rest.partition('<!-- /floors -->')
    return f'{before}<!-- floors -->\n{floors_table()}\n{foot}{after}'


def write() -> None:
    """Draw the table again."""
    DESIGN.write_text(drawn(DESIGN.read_text(encoding='utf-8')), encoding='utf-8')


if __name__ == '__main__':
    write()
