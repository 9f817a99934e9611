"""States of a net in a flume tank: their table is read, or refused, and solved on its floor."""

import math
from dataclasses import replace

import pytest

from trawl_ros.core.errors import TrawlError
from trawl_ros.gear.load import load_gear
from trawl_ros.lab.validation.tank import flume
from trawl_ros.lab.validation.tank.doubts import DOUBTS, Doubted, doubts_table
from trawl_ros.lab.validation.tank.flume import TABLE, Compared, checks, exponent, further_table
from trawl_ros.lab.validation.tank.held import HEIGHT_TOLERANCE_M, held, led_to
from trawl_ros.lab.validation.tank.states import BRIDLE, SHACKLE, FlumeState, read_states

TEXT = """\
trial,trawl,bridles,bridle_length,catch,pulling_point_elevation_mm,towing_speed_kn,\
spread_u_wing_m,opening_headline_m,bridle_tension_total_t,door_spread_m,bridle_angle_deg,\
spread_l_wing_m,upper_wingend_height_m
1.0,83-112,standard,normal,empty,200.0,2.0,17.84,2.72,,74.0,22.4,20.16,1.4
2.0,83-112,2,short,1,300.0,3.0,17.52,2.4,2.4,69.8,20.3,,1.2
3.0,PNE,standard,normal,empty,200.0,2.0,16.0,6.4,2.6,60.4,20.0,17.0,2.0
"""

STATE = FlumeState('1', False, False, False, 0.2, 60.8, 1.5, 17.5, 2.0, 2.0e4)


def test_a_table_gives_the_states_of_one_trawl_in_si(tmp_path):
    path = tmp_path / 'tank.csv'
    path.write_text(TEXT)
    first, second = read_states(path)
    assert first.counts
    assert not second.counts
    assert first.speed == pytest.approx(1.0289, abs=1e-4)
    assert math.isnan(first.tension)
    # Without the legs the ropes from masts to lower wings are the bridles and what lengthens them.
    way = (first.pulling_points - first.lower_spread) / 2.0 / math.sin(math.radians(22.4))
    assert way == pytest.approx(BRIDLE + SHACKLE, abs=0.2)
    assert second.tension == pytest.approx(2.4 * 9806.65)
    assert (second.sweeps, second.short, second.catch) == (True, True, True)


@pytest.mark.parametrize(
    'text', ['', 'a,b\n1,2\n', TEXT.replace('74.0', 'x'), TEXT.replace('83-112', 'other')]
)
def test_what_is_no_such_table_is_refused(tmp_path, text):
    path = tmp_path / 'tank.csv'
    path.write_text(text)
    with pytest.raises(TrawlError, match=r'tank\.csv: .*expected'):
        read_states(path)


@pytest.fixture(scope='module')
def coarse():
    gear = load_gear('flume_83_112')
    return gear.model_copy(update={'netting': gear.netting.model_copy(update={'around': 24})})


def test_the_footrope_lies_on_the_floor_which_pushes_and_does_not_pull(coarse):
    net = held(coarse, STATE)
    seen = net.found.observables
    assert seen.net_depth + seen.vertical_opening == pytest.approx(0.2, abs=HEIGHT_TOLERANCE_M)
    assert 0.0 < net.floor < 25.0 * 34.1
    assert 0.0 < net.wing_height < net.height + 0.1
    assert net.lower_spread > net.spread
    assert 0.0 < net.lower_share < 0.5


def test_pulling_points_further_apart_open_the_wings_and_lower_the_mouth(coarse):
    near, far = (held(coarse, replace(STATE, pulling_points=apart)) for apart in (52.0, 60.8))
    assert far.spread > near.spread + 1.0
    assert far.height < near.height


def test_checks_tell_errors_and_the_exponent(coarse):
    net = held(coarse, STATE)
    same = replace(STATE, spread=net.spread, height=net.height, tension=1.2 * net.tension)
    rows = {row.key: row for row in checks([Compared(same, net), Compared(same, None, 'no')])}
    assert rows['median_error'].value == math.inf
    assert not rows['steady_states'].ok
    rows = {row.key: row for row in checks([Compared(same, net)])}
    assert rows['median_error'].value == pytest.approx(0.0)
    assert 'tension -16.7 %' in rows['median_error'].note
    assert exponent([(1.0, 3.0), (2.0, 12.0)]) == pytest.approx(2.0)
    assert f'{net.floor:.0f} N' in further_table([Compared(same, net)]).rows[2]


def test_without_the_table_a_sentence_says_that_nothing_was_run(tmp_path, monkeypatch):
    monkeypatch.setattr(flume, 'TABLE', tmp_path / 'tank.csv')
    found = flume.run(True)
    assert found.rows == ()
    assert 'tank.csv: not found' in found.text


@pytest.mark.skipif(not TABLE.is_file(), reason='the measured states are not beside this')
def test_the_small_version_solves_some_of_the_measured_states():
    found = flume.run(True)
    assert {row.key for row in found.rows} == {'median_error', 'exponent', 'steady_states'}
    assert len(found.tables) == 2


def test_a_doubt_changes_its_number_and_tells_what_the_height_needs(coarse):
    net = held(coarse, STATE)
    fast = replace(STATE, trial='64.0', height=1.1 * net.height, tension=net.tension)
    slow = replace(STATE, trial='67.0', speed=1.0, tension=0.5 * net.tension)
    for doubt in DOUBTS:
        assert doubt.change(coarse, 1.0) == coarse
        assert (doubt.change(coarse, 0.9) != coarse) == (doubt.low < doubt.high)
    slower = held(coarse, slow)
    missing = dict.fromkeys(DOUBTS[0].factors)
    table = doubts_table(
        [Doubted(DOUBTS[0], {1.0: net} | missing, {1.0: slower} | missing)], [fast, slow]
    )
    assert [row[1] for row in table.rows] == ['', '', '× 0.6', '× 1.4']
    assert table.rows[1][3] == f'{net.height:.2f}'
    assert table.rows[2][2:7] == ('–', '–', '–', '–', 'not enough')


@pytest.mark.skipif(not TABLE.is_file(), reason='the measured states are not beside this')
def test_the_measured_states_are_those_that_were_chosen():
    states = read_states(TABLE)
    assert len(states) == 38
    counting = [state.trial for state in states if state.counts]
    assert counting == ['1.0', '2.0', '3.0', '4.0', '5.0', '6.0', '8.0', '9.0', '10.0',
                        '63.0', '65.0', '66.0', '67.0']  # fmt: skip


@pytest.mark.slow
def test_a_net_is_led_from_one_state_to_another_and_has_the_drag_of_small_twine(coarse):
    net = held(coarse, STATE)
    slower = replace(STATE, speed=1.35, pulling_points=58.0)
    led, cold = led_to(coarse, slower, STATE, net), held(coarse, slower)
    for name in ('spread', 'height', 'tension'):
        assert getattr(led, name) == pytest.approx(getattr(cold, name), rel=0.01)
    power = math.log(net.tension / led.tension) / math.log(STATE.speed / slower.speed)
    assert 1.4 < power < 2.0
    assert held(coarse, STATE, tank_twine=False).tension < 0.9 * net.tension
