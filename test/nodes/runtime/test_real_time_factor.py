"""How fast stamps go against wall time; a jump backward begins again and is no speed."""

from trawl_ros.core.time import SECOND
from trawl_ros.nodes.runtime.traffic import RealTimeFactor


class Wall:
    """Wall time that passes when told to."""

    time = 5.0

    def __call__(self):
        return self.time


def test_the_factor_is_that_since_the_last_report():
    wall = Wall()
    real_time_factor = RealTimeFactor(wall)
    for second in range(100, 121):
        real_time_factor.reached(second * SECOND)
    wall.time += 2.0
    assert real_time_factor.report() == {'data time': '120.0', 'real-time factor': '10.00'}
    real_time_factor.reached(121 * SECOND)
    wall.time += 2.0
    assert real_time_factor.report()['real-time factor'] == '0.50'
    wall.time += 1.0
    assert real_time_factor.report()['real-time factor'] == '0.00'


def test_a_jump_backward_counts_nothing():
    wall = Wall()
    real_time_factor = RealTimeFactor(wall)
    for second in (50, 51, 0, 1):
        real_time_factor.reached(second * SECOND)
    wall.time += 1.0
    assert real_time_factor.report() == {'data time': '1.0', 'real-time factor': '2.00'}


def test_what_is_not_driven_by_stamps_reports_no_factor():
    assert RealTimeFactor(Wall()).report() == {}
