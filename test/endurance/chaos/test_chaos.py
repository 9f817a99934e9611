"""Chaos in the graph: what happens is planned from a seed, and what is seen is reported."""

from dataclasses import replace
from pathlib import Path

import pytest

pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')


from endurance.chaos.crew import Recording
from endurance.chaos.kills import Kills
from endurance.chaos.plan import REPERTOIRE, Plan, faults_of
from endurance.chaos.rows import chaos_sections
from endurance.chaos.run import Chaos, run_chaos, same_stretches
from endurance.chaos.tow import DisturbedTow
from endurance.table import FULL
from endurance.watching import Glance
from trawl_ros.core.progress import ignore
from trawl_ros.core.time import SECOND
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.records.coefficients import COEFFICIENTS

NODES = ('sim_node', 'bag_recorder', 'winch_node', 'door_sensor_node', 'trawl_sonar_node',
         'vessel_node', 'identification_node')  # fmt: skip


def estimate(value=1.0, windows='3'):
    named = {name: str(value) for name in COEFFICIENTS}
    ends = {f'{name} {end}': str(value + at) for name in COEFFICIENTS
            for end, at in (('low', -0.2), ('high', 0.2))}  # fmt: skip
    return {'windows': windows, 'reason': '', 'rejected gap': '2', **named, **ends}


def alike(value=1.0):
    return {key: float(number) for key, number in estimate(value).items() if key[1].isdigit()}


def tow(value=1.0, **kwargs):
    memory = dict.fromkeys(NODES, 200.0)
    seen = Glance(3599.0, 80.0, memory, memory, {})
    bags = [Recording(Path('bag0'), 'killed', 9.0, 0.4, 100), Recording(Path('bag1'), messages=5)]
    made = DisturbedTow(glances=[seen], recordings=bags, towed_s=3599.5, estimate=estimate(value))
    return replace(made, **kwargs)


def window(start_s, end_s):
    return SteadyWindow(0, 0, start_s * SECOND, end_s * SECOND, {}, {}, {}, {})


def sections(wild, calm=None, kills=None, same=None):
    same = alike() if same is None else same
    return chaos_sections(Chaos(Plan(), calm or tow(), wild, kills or Kills((), 0.0), same))


def missed(*args, **kwargs):
    return [row.what for section in sections(*args, **kwargs) for row in section.missed]


def test_an_hour_holds_every_fault_once_in_the_order_of_a_seed():
    faults = faults_of(Plan())
    assert sorted((f.kind, f.target) for f in faults) == sorted(REPERTOIRE)
    assert [f.at_s for f in faults] == sorted(f.at_s for f in faults)
    assert 180.0 <= faults[0].at_s < faults[-1].at_s <= 3420.0
    assert faults == faults_of(Plan())
    assert [f.target for f in faults] != [f.target for f in faults_of(Plan(seed=17))]


def test_a_tow_that_took_no_harm_reaches_every_target():
    assert missed(tow(1.19)) == []


@pytest.mark.parametrize(
    ('harm', 'row'),
    [
        ({'value': 1.21}, 'estimate off the undisturbed one of the same stretches'),
        ({'towed_s': 3000.0}, 'tow that is missing to the whole'),
        ({'died': [(7.0, 'winch_node ended with code 1; its last output (x):\n  ouch')]},
         'nodes ended by themselves'),
        ({'mute': ['bag_recorder goes on']}, 'full disks that were not told in a sentence'),
        ({'recordings': [Recording(Path('bag0'), problem='nothing can be saved')]},
         'bags that cannot be read, repaired'),
        ({'recordings': [Recording(Path('bag0'), 'killed', 9.0, 1.1, 100)]},
         'lost before kills and full disks'),
        ({'estimate': {'windows': '0', 'reason': ''}},
         'estimates without a reason why there is none'),
    ],
)  # fmt: skip
def test_each_harm_is_a_target_missed(harm, row):
    assert row in missed(tow(**harm))


def test_windows_that_a_fault_has_cost_are_no_error_of_the_estimate_and_are_told():
    rows = {row.what: row for row in sections(tow(1.3), same=alike(1.2))[2].rows}
    assert 'left out, as it says: gap 2' in rows['windows of the disturbed tow'].note
    assert rows['estimate off the undisturbed one of the same stretches'].ok
    assert rows['estimate off that of the whole undisturbed tow'].value == pytest.approx(1.5)
    whole = rows['undisturbed estimate of these stretches off that of the whole']
    assert whole.value == pytest.approx(1.0)


def test_tows_without_a_stretch_in_common_cannot_be_compared():
    assert missed(tow(), same={}) == ['estimate off the undisturbed one of the same stretches']


def test_stretches_are_the_same_where_windows_overlap():
    calm = [window(0, 60), window(60, 120), window(300, 360), window(500, 560)]
    assert same_stretches(calm, [window(30, 60), window(340, 400)]) == [calm[0], calm[2]]


def test_no_estimate_is_well_where_the_reason_is_said():
    assert missed(tow(estimate={'windows': '0', 'reason': 'no steady window'})) == []


def test_a_tow_on_which_no_recorder_was_cut_short_has_lost_nothing():
    assert missed(tow(recordings=[Recording(Path('bag0'), messages=5)])) == []


def test_the_worst_of_the_kills_counts():
    killed = [Recording(Path('bag'), 'killed', 9.0, lost, 100, 1) for lost in (0.2, 1.3, 0.1)]
    assert missed(tow(), kills=Kills(tuple(killed), 3.0)) == ['lost before the kill']


@pytest.mark.ros
@pytest.mark.slow
@pytest.mark.timeout(0 if FULL else 500)
def test_a_tow_with_faults_and_kills_takes_no_harm(tmp_path, show):
    plan = Plan() if FULL else Plan(hours=0.05, kills=2, seed=3)
    chaos = run_chaos(plan, tmp_path, ignore, lambda: False)
    rows = [row for section in chaos_sections(chaos) for row in section.rows]
    show('Faults in the graph', rows)
    assert [fault.kind for fault in chaos.wild.done] == [f.kind for f in faults_of(plan)]
    assert [row.what for row in rows if not row.ok] == []
    assert len(chaos.kills.recordings) == plan.kills
    assert not list(tmp_path.glob('*/bag*')), 'bags are gone again'
