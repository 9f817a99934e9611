"""The case on fastening points moved forward, with a coarse net."""

from trawl_ros.lab.validation.branches.fastening_points import CASE


def test_boards_are_calmer_with_the_warp_point_a_little_forward_and_fold_with_it_far_forward() -> (
    None
):
    found = CASE.run(True)
    checks = {check.key: check for check in found.rows}
    assert checks['folds_shipped'].ok
    assert checks['swing_10_cm'].ok
    assert checks['folds_10_cm'].ok
    assert checks['folds_30_cm'].value >= 1.0
    assert 'm: at ' in checks['folds_30_cm'].note
    (table,) = found.tables
    assert [row[0] for row in table.rows] == ['shipped', '0.1 m forward', '0.3 m forward']
