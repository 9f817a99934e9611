"""Compiled loops are kept on the machine, and a node can tell beforehand."""

from pathlib import Path
from types import SimpleNamespace

from trawl_ros.model.bar_pass import add_bar_blocks
from trawl_ros.model.compiled import is_cached
from trawl_ros.model.gear_model import GearModel
from trawl_ros.solver.equilibrium import steady_state


def test_what_was_compiled_is_known(model: GearModel) -> None:
    steady_state(model, 500.0, 2.1)
    assert is_cached(add_bar_blocks)


def test_what_was_never_compiled_is_known(tmp_path: Path) -> None:
    stats = SimpleNamespace(cache_path=str(tmp_path))
    assert not is_cached(SimpleNamespace(__name__='add_bar_blocks', stats=stats))
    (tmp_path / 'bar_pass.add_bar_blocks-75.py311.nbi').touch()
    assert is_cached(SimpleNamespace(__name__='add_bar_blocks', stats=stats))
