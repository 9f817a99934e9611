"""Tables of docs/design.md, drawn from the contract in pyproject.toml and from the packages."""

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
    """Folders of each floor, the highest first; those to come stay out."""
    rows = [re.findall(r'\w+', row) for row in contracts()['layers']['layers']]
    rows = [[name for name in row if (PACKAGE / name).is_dir()] for row in rows]
    return [row for row in rows if row]


def sentence(folder: Path) -> str:
    """First line of a package's docstring."""
    text = (folder / '__init__.py').read_text(encoding='utf-8')
    return (ast.get_docstring(ast.parse(text)) or '').partition('\n')[0]


def floors_table() -> str:
    """Floors with their folders and what is in them."""
    rows = [
        f'| {number} | `{name}/` | {sentence(PACKAGE / name)} |'
        for number, row in zip(range(len(floors()), 0, -1), floors())
        for name in row
    ]
    return '\n'.join(['| floor | folder | what is in it |', '|---|---|---|', *rows])


def rooms_table() -> str:
    """Folders inside folders and what is in them."""
    rows = [
        f'| `{folder.relative_to(PACKAGE).as_posix()}/` | {sentence(folder)} |'
        for folder in sorted(path.parent for path in PACKAGE.rglob('__init__.py'))
        if len(folder.relative_to(PACKAGE).parts) > 1
    ]
    return '\n'.join(['| folder | what is in it |', '|---|---|', *rows])


def drawn(text: str) -> str:
    """The document with both tables as they should be."""
    for name, table in (('floors', floors_table()), ('rooms', rooms_table())):
        head, foot = f'<!-- {name} -->', f'<!-- /{name} -->'
        before, _, rest = text.partition(head)
        text = f'{before}{head}\n{table}\n{foot}{rest.partition(foot)[2]}'
    return text


def write() -> None:
    """Draw the tables anew."""
    DESIGN.write_text(drawn(DESIGN.read_text(encoding='utf-8')), encoding='utf-8')


if __name__ == '__main__':
    write()
