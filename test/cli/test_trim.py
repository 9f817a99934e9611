"""Lines about trimmed boards: boards that lean inward are told from those that lean outward."""

from types import SimpleNamespace

from trawl_ros.cli.trim import state_line
from trawl_ros.records.observables import OBSERVABLES, Observables


def line(roll: float) -> str:
    seen = Observables(
        **{**dict.fromkeys(OBSERVABLES, 0.0), 'port_roll': roll, 'port_inclination': abs(roll)}
    )
    steady = SimpleNamespace(observables=seen, stability=SimpleNamespace(settling_time=100.0))
    return state_line(150.0, 1.45, steady)  # type: ignore[arg-type]


def test_boards_that_lean_inward_are_told_from_those_that_lean_outward() -> None:
    assert 'δ 8.0° inward, β' in line(-0.14)
    assert 'δ 8.0°, β' in line(0.14)
