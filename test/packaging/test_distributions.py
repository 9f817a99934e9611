"""The package uses no name of rclpy that Jazzy or Kilted deprecates, for Lyrical may lack it."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FILES = sorted(path for folder in ('trawl_ros', 'launch') for path in (ROOT / folder).rglob('*.py'))

MODULES = {'rclpy.qos_event'}
NAMES = {
    'QoSEventHandler', 'QoSPublisherEventType', 'QoSSubscriptionEventType',
    'UnsupportedEventTypeError', 'get_package_prefix', 'get_message', 'RMW_QOS_POLICY',
}  # fmt: skip
"""Deprecated names, as rclpy 7.1 and 9.1 mark them; the last one is the beginning of many."""

MAY_BE_ABSENT = {'rclpy.experimental'}
"""Modules that are looked for, and done without."""


def ros_imports(tree: ast.AST) -> dict[str, set[str]]:
    """Names that are imported from rclpy, by module."""
    found: dict[str, set[str]] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or '').startswith('rclpy'):
            found.setdefault(str(node.module), set()).update(name.name for name in node.names)
    return found


def tried(tree: ast.AST) -> set[str]:
    """Modules that are imported within ``try`` with an answer to their absence."""
    return {
        str(statement.module)
        for node in ast.walk(tree)
        if isinstance(node, ast.Try)
        for statement in node.body
        if isinstance(statement, ast.ImportFrom)
    }


@pytest.mark.parametrize('path', FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_no_deprecated_name_of_rclpy_is_used(path):
    text = path.read_text(encoding='utf-8')
    if 'rclpy' not in text:
        return
    tree = ast.parse(text)
    imports = ros_imports(tree)
    assert not MODULES & imports.keys()
    used = {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
    used |= set().union(*imports.values()) if imports else set()
    assert not used & NAMES
    assert not [name for name in used if name.startswith('RMW_QOS_POLICY')]
    assert not [
        node.lineno
        for node in ast.walk(tree)
        # A logger's warn() is deprecated; Python's own warnings module has one too.
        if isinstance(node, ast.Attribute)
        and node.attr == 'warn'
        and 'logger' in ast.unparse(node.value)
    ]
    assert imports.keys() & MAY_BE_ABSENT <= tried(tree)
