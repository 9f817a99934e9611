"""All targets by name; a new one is added to a module of `hostile.targets` listed here."""

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType

from hostile.target import Files, Target
from hostile.targets import bag_files, checkpoints, logs, messages, tows, yaml_files

_MODULES = (yaml_files, bag_files, logs, messages, checkpoints, tows)

TARGETS: Mapping[str, Target] = MappingProxyType(
    {target.name: target for module in _MODULES for target in module.TARGETS}
)

CORPUS = Path(__file__).parents[1] / 'corpus'


def known(target: Target) -> dict[str, Files]:
    """Inputs that once broke a target: those of its corpus, and those it makes."""
    made = {name: make() for name, make in target.known.items()}
    folders = sorted(path for path in (CORPUS / target.name).glob('*') if path.is_dir())
    return made | {folder.name: files_in(folder) for folder in folders}


def files_in(folder: Path) -> Files:
    """Read a folder as an input."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob('*'))
        if path.is_file()
    }
