"""Lines about trimmed boards say if the upper edge leans outward."""

from types import SimpleNamespace

from trawl_ros.cli.trim import state_line
from trawl_ros.records.observables import OBSERVABLES, Observables


def line(roll: float) -> str:
    seen = Observables(
        **{**dict.fromkeys(OBSERVABLES, 0.0), 'port_roll': roll, 'port_inclination': abs(roll)}
    )
    steady = SimpleNamespace(observables=seen, stability=SimpleNamespace(settling_time=100.0))
    return state_line(150.0, 1.45, steady)  # type: ignore[arg-type]


def test_an_upper_edge_that_leans_outward_is_printed() -> None:
    # Roll is positive with the top to starboard, which is inward for the port board.
    assert 'δ 8.0°, upper edge outward, β' in line(-0.14)
    assert 'δ 8.0°, β' in line(0.14)
