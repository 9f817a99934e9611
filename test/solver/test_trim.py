"""Trim finds fastening points at which the boards work as wanted."""

import numpy as np
import pytest

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.gear.records import EffectRecord, GearRecord
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.solver.equilibrium import steady_state
from trawl_ros.solver.trim import trim


def test_the_trimmed_gear_works_at_the_wanted_angles(model: GearModel) -> None:
    found = trim(
        model, attack=np.radians(22.0), inclination=np.radians(15.0), warp_length=500.0, speed=2.1
    )
    seen = found.steady.observables
    for attack, lean in (
        (seen.port_attack, seen.port_inclination),
        (seen.starboard_attack, seen.starboard_inclination),
    ):
        assert np.degrees(attack) == pytest.approx(22.0, abs=0.01)
        assert np.degrees(lean) == pytest.approx(15.0, abs=0.01)
    # A positive δ leans the upper edges inward: that of the port board to starboard.
    assert seen.port_roll > 0.0 > seen.starboard_roll
    # Close to the rigging it started from, and the same when found cold.
    assert np.abs(found.points - model.board.points).max() < 1.0
    again = steady_state(model.with_board(points=found.points), 500.0, 2.1)
    assert again.observables.door_spread == pytest.approx(seen.door_spread, rel=1e-5)


def test_impossible_angles_are_refused(model: GearModel) -> None:
    with pytest.raises(NoSteadyState, match='pitch'):
        trim(
            model,
            attack=0.35,
            inclination=np.radians(5.0),
            pitch=np.radians(10.0),
            warp_length=500.0,
            speed=2.1,
        )


def test_effects_of_the_gear_file_act_while_points_are_sought(gear: GearRecord) -> None:
    drag = EffectRecord(name='net_drag', values={'factor': 1.2})
    model = build_model(gear.model_copy(update={'effects': (drag,)}))
    wanted = {'attack': np.radians(20.0), 'inclination': np.radians(14.0)}
    seen = trim(model, **wanted, warp_length=500.0, speed=2.1).steady.observables
    assert seen.port_attack == pytest.approx(wanted['attack'], abs=1e-4)
    assert seen.port_inclination == pytest.approx(wanted['inclination'], abs=1e-4)
