"""Count lines of code, without docstrings, comments, blank lines and imports.

``python test/tools/count_code.py`` prints the rooms of the package and their sum;
``python test/tools/count_code.py FOLDER ...`` prints these folders alone.
"""

import ast
import io
import sys
import tokenize
from dataclasses import dataclass
from pathlib import Path

PACKAGE = Path(__file__).parents[2] / 'trawl_ros'
NO_CODE = {tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT,
           tokenize.ENCODING, tokenize.ENDMARKER}  # fmt: skip


@dataclass(frozen=True)
class Count:
    """Number of files, of all their lines, and of lines of code."""

    files: int = 0
    raw: int = 0
    code: int = 0

    def __add__(self, other: 'Count') -> 'Count':
        return Count(self.files + other.files, self.raw + other.raw, self.code + other.code)


def lines_of_code(text: str) -> int:
    """Return the number of lines that hold code.

    A string that stands alone as a statement documents what is around it, so it does not count.
    """
    with_code: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type not in NO_CODE:
            with_code.update(range(token.start[0], token.end[0] + 1))
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import | ast.ImportFrom) or _is_text(node):
            with_code.difference_update(range(node.lineno, node.end_lineno + 1))
    return len(with_code)


def _is_text(node: ast.AST) -> bool:
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )


def count_folder(folder: Path) -> Count:
    """Count all Python files below a folder."""
    found = Count()
    for path in sorted(folder.rglob('*.py')):
        text = path.read_text(encoding='utf-8')
        found += Count(1, len(text.splitlines()), lines_of_code(text))
    return found


def main(folders: list[Path]) -> None:
    """Print a line for each folder, and their sum."""
    rooms = folders or sorted(path.parent for path in PACKAGE.glob('*/__init__.py'))
    counts = {str(room if folders else room.name): count_folder(room) for room in rooms}
    if not folders:
        whole = count_folder(PACKAGE)
        inside = sum(counts.values(), Count())
        counts['trawl_ros/*.py'] = Count(
            whole.files - inside.files, whole.raw - inside.raw, whole.code - inside.code
        )
    counts['sum'] = sum(counts.values(), Count())
    print(f'{"room":20} {"files":>6} {"lines":>7} {"code":>7}')
    for name, count in counts.items():
        print(f'{name:20} {count.files:6} {count.raw:7} {count.code:7}')


if __name__ == '__main__':
    main([Path(word) for word in sys.argv[1:]])
