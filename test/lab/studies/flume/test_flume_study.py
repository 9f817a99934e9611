"""States of a net in a flume tank: their table is read, or refused, and solved on its floor."""

import math
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner

from trawl_ros.cli.main import trawl
from trawl_ros.core.errors import TrawlError
from trawl_ros.gear.load import load_gear
from trawl_ros.lab.studies.flume.held import PRECISE, held
from trawl_ros.lab.studies.flume.states import FlumeState, read_states
from trawl_ros.lab.studies.flume.study import Compared, exponent, rows_of

MEASURED = Path(__file__).parents[5] / 'shared/data/noaa_trawlmetrics/flume_tank_2025_2026.csv'

TEXT = """\
trial,trawl,bridles,bridle_length,catch,pulling_point_elevation_mm,towing_speed_kn,\
spread_u_wing_m,opening_headline_m,bridle_tension_total_t,door_spread_m
1.0,83-112,standard,normal,empty,200.0,2.0,17.84,2.72,,74.0
2.0,83-112,2,short,1,300.0,3.0,17.52,2.4,2.4,69.8
3.0,PNE,standard,normal,empty,200.0,2.0,16.0,6.4,2.6,60.4
"""

STATE = FlumeState('1', False, False, False, 0.2, 72.0, 1.5, 17.5, 2.0, 2.0e4)


def test_a_table_gives_the_states_of_one_trawl_in_si(tmp_path):
    path = tmp_path / 'tank.csv'
    path.write_text(TEXT)
    first, second = read_states(path)
    assert first.counts
    assert not second.counts
    assert first.speed == pytest.approx(1.0289, abs=1e-4)
    assert math.isnan(first.tension)
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
    words = ['study', 'flume', '--table', str(path), '--out', str(tmp_path / 'out')]
    assert CliRunner().invoke(trawl, words).exit_code == 1
    assert not (tmp_path / 'out').exists()


@pytest.fixture(scope='module')
def coarse():
    gear = load_gear('flume_83_112')
    return gear.model_copy(update={'netting': gear.netting.model_copy(update={'around': 24})})


def test_the_footrope_lies_on_the_floor_which_pushes_and_does_not_pull(coarse):
    net = held(coarse, STATE)
    seen = net.found.observables
    assert seen.net_depth + seen.vertical_opening == pytest.approx(0.2, abs=PRECISE)
    assert 0.0 < net.floor < 25.0 * 34.1


def test_pulling_points_further_apart_open_the_wings_and_lower_the_mouth(coarse):
    near, far = (held(coarse, replace(STATE, pulling_points=apart)) for apart in (60.0, 72.0))
    assert far.spread > near.spread + 1.0
    assert far.height < near.height


def test_rows_tell_errors_and_the_exponent(coarse):
    net = held(coarse, STATE)
    same = replace(STATE, spread=net.spread, height=net.height, tension=1.2 * net.tension)
    rows = {row.what: row for row in rows_of([Compared(same, net), Compared(STATE, None, 'no')])}
    assert rows['median error of tension'].value == math.inf
    rows = {row.what: row for row in rows_of([Compared(same, net)])}
    assert rows['median error of spread'].value == pytest.approx(0.0)
    assert rows['median error of tension'].value == pytest.approx(100.0 / 6.0)
    assert exponent([(1.0, 3.0), (2.0, 12.0)]) == pytest.approx(2.0)


@pytest.mark.skipif(not MEASURED.is_file(), reason='the measured states are not beside this')
def test_the_measured_states_are_those_that_were_chosen():
    states = read_states(MEASURED)
    assert len(states) == 38
    counting = [state.trial for state in states if state.counts]
    assert counting == ['1.0', '2.0', '3.0', '4.0', '5.0', '6.0', '8.0', '9.0', '10.0',
                        '63.0', '65.0', '66.0', '67.0']  # fmt: skip
