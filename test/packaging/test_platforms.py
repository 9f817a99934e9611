"""What needs no ROS imports no module of POSIX alone, and starts without its functions."""

import ast
from collections.abc import Iterator
from pathlib import Path

from trawl_ros.core import first_start

PACKAGE = Path(first_start.__file__).parents[1]
POSIX = {
    'crypt',
    'fcntl',
    'grp',
    'nis',
    'posix',
    'pty',
    'pwd',
    'resource',
    'syslog',
    'termios',
    'tty',
}


def imported(tree: ast.Module) -> Iterator[str]:
    """Modules that are imported as a file is, and not in its functions."""
    waiting = list(tree.body)
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.Import):
            yield from (alias.name.partition('.')[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield (node.module or '').partition('.')[0]
        elif not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            waiting += ast.iter_child_nodes(node)


def test_only_nodes_import_modules_of_posix():
    files = [file for file in PACKAGE.rglob('*.py') if 'nodes' not in file.parts]
    assert len(files) > 500
    found = {file.name: POSIX & set(imported(ast.parse(file.read_text()))) for file in files}
    assert {name: modules for name, modules in found.items() if modules} == {}


def test_a_start_without_a_home_and_without_user_numbers_is_no_error(monkeypatch):
    monkeypatch.delattr('os.getuid')
    monkeypatch.delenv('HOME', raising=False)
    assert first_start.private_folder() is None
    assert first_start.need_home() is False
