"""The case on refinement: what differences are shares of, and what it says of a coarse net."""

import numpy as np
import pytest

from trawl_ros.lab.validation.convergence.refinement import CASE, differences
from trawl_ros.records.observables import OBSERVABLES


def test_differences_are_shares_of_the_value_and_of_30_degrees_around_zero() -> None:
    fine = np.full(len(OBSERVABLES), -0.5)
    shares = dict(zip(OBSERVABLES, differences(fine + 0.01, fine), strict=True))
    assert shares['door_spread'] == pytest.approx(0.02)
    assert shares['port_roll'] == pytest.approx(0.02)
    assert shares['port_pitch'] == pytest.approx(0.01 / np.radians(30.0))
    assert shares['starboard_slip'] == pytest.approx(0.01 / np.radians(30.0))


def test_warp_and_bridles_are_fine_enough_even_for_a_coarse_net_and_the_rest_has_a_reason() -> None:
    outcome = CASE.run(True)
    checks = {check.key: check for check in outcome.rows}
    of_nets = {'angles_straight', 'angles_bowed', 'sizes_straight', 'sizes_bowed'}
    assert set(checks) == {'warp_500', 'bridle_500', 'joins_500', 'net_500', 'all_500'} | of_nets
    assert checks['warp_500'].ok
    assert checks['bridle_500'].ok
    for check in outcome.rows:
        assert np.isfinite(check.value)
        assert check.ok or 'numerical meshes around' in check.note
    assert checks['angles_straight'].note.endswith('within 0.5°: 12.')
    *by_length, bowed = outcome.tables
    assert {len(table.rows) for table in by_length} == {len(OBSERVABLES)}
    assert [row[0] for row in bowed.rows] == ['straight', 'straight', 'bowed', 'bowed']
