"""What is installed is held to hashes, and to no version with a published hole."""

import re
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.version import Version

ROOT = Path(__file__).parents[2]
LOCK = re.split(r'\n(?=[a-zA-Z0-9])', (ROOT / 'requirements.lock').read_text())
PINNED = [block for block in LOCK if '==' in block.split('\n', 1)[0]]
REPAIRED = {'jinja2': '3.1.6', 'cryptography': '42.0.4', 'setuptools': '78.1.1'}
"""First versions without the holes that are known."""


def declared(*files: str) -> dict[str, list[Requirement]]:
    """Requirements of files by name."""
    found: dict[str, list[Requirement]] = {}
    for file in files:
        # The lock is of Jazzy; packages of Kilted are installed by hand.
        source = re.sub(r'KILTED = \[.*?\n\]\n', '', (ROOT / file).read_text(), flags=re.DOTALL)
        for text in re.findall(r"'([A-Za-z][\w.-]*[<>=~][^' ]*)'", source):
            requirement = Requirement(text)
            found.setdefault(requirement.name.lower(), []).append(requirement)
    return found


def test_every_pinned_package_has_its_hashes() -> None:
    assert len(PINNED) > 200
    assert [block.split()[0] for block in PINNED if '--hash=sha256:' not in block] == []


@pytest.mark.parametrize('name', REPAIRED)
def test_versions_with_known_holes_are_excluded(name: str) -> None:
    first = Version(REPAIRED[name])
    requirements = declared('setup.py', 'pyproject.toml')[name]
    for requirement in requirements:
        below = Version(f'{first.major}.{first.minor}.{first.micro - 1}')
        assert first in requirement.specifier
        assert below not in requirement.specifier


def test_all_that_is_declared_is_pinned_within_its_bounds() -> None:
    pinned = {}
    for block in PINNED:
        name, _, version = block.split()[0].partition('==')
        pinned.setdefault(name.lower(), []).append(Version(version))
    for name, requirements in declared('setup.py').items():
        if name.startswith(('rerun-sdk', 'foxglove')):
            continue
        found = pinned.get(name, pinned.get(f'ros-jazzy-{name}', []))
        for requirement in requirements:
            assert found, name
            assert all(version in requirement.specifier for version in found), name
