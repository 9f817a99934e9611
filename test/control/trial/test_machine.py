"""A trial goes where it is advised, holds when it should, and obeys its operator."""

import pytest

from trawl_ros.control.trial.memory import load_memory, save_memory
from trawl_ros.control.trial.records import TrialSettings, TrialTarget
from trawl_ros.core.errors import TrawlError
from trawl_ros.records.samples import HeadingSample

SETTINGS = TrialSettings(hours=6.0)
HOLD_S = 2.0


@pytest.fixture
def ship(sailing):
    """On the way from 300 m to 400 m, after two windows."""
    ship = sailing(SETTINGS)
    ship.sail(5.0)
    ship.windows(2)
    ship.sail(20.0)
    assert ship.state.phase == 'transit'
    assert ship.lengths[0] > 300.0
    return ship


def moved(ship, seconds):
    before = ship.lengths, ship.speed
    ship.sail(seconds)
    return (ship.lengths, ship.speed) != before


def stands_within(ship, seconds=HOLD_S):
    """True if ship and winches hold after so many seconds, and it says why."""
    ship.sail(seconds)
    return bool(ship.state.held) and not moved(ship, 10.0)


def test_it_begins_where_the_ship_is_and_goes_where_it_is_advised(sailing):
    ship = sailing(SETTINGS)
    ship.sail(600.0)
    assert (ship.state.phase, str(ship.state.target)) == ('tow', '300 m at 2.10 m/s')
    assert ship.lengths == (300.0, 300.0)
    ship.windows(1)
    ship.sail(10.0)
    assert ship.state.phase == 'tow'
    ship.windows(2)
    ship.sail(1.0)
    assert (ship.state.phase, str(ship.state.target)) == ('transit', '400 m at 2.10 m/s')
    ship.sail(400.0)
    assert ship.state.phase == 'tow'
    assert ship.lengths == (400.0, 400.0)
    assert ship.speed == 2.1
    ship.windows(4)
    ship.sail(1.0)
    assert ship.state.target.port == 500.0
    assert ship.state.towed == 2


def test_nothing_is_commanded_before_all_that_is_needed_is_read(sailing):
    ship = sailing(SETTINGS, silent={'log'})
    ship.sail(60.0)
    assert all(command is None for _, command in ship.commands)
    assert str(ship.state.waits).endswith('readings of speed')
    ship.silent.clear()
    ship.sail(3.0)
    assert ship.state.phase == 'tow'


@pytest.mark.parametrize(
    ('instrument', 'said'),
    [
        ('winch', 'port_length is stale'),
        ('log', 'speed is stale'),
        ('sonar', 'net_depth is stale'),
        ('compass', 'heading is stale'),
    ],
)
def test_it_holds_within_two_seconds_of_a_reading_that_ceases_and_goes_on(ship, instrument, said):
    while ship.now % 1.0:
        ship.sail(0.5)
    ship.silent.add(instrument)
    assert stands_within(ship)
    assert said in ship.state.held
    ship.silent.clear()
    assert moved(ship, 3.0)
    assert not ship.state.held


def test_it_holds_within_two_seconds_of_a_lost_node(ship):
    ship.lost = ('identification_node',)
    assert stands_within(ship)
    assert str(ship.state) == 'holds: identification_node is lost'
    ship.lost = ()
    assert moved(ship, 3.0)


def test_a_frozen_load_cell_and_a_winch_that_does_not_follow_make_it_hold(ship, monkeypatch):
    monkeypatch.setattr('math.sin', lambda _: 0.25)
    ship.sail(8.0)
    assert any('is frozen' in why for why in ship.state.held)
    monkeypatch.undo()
    ship.sail(3.0)
    assert not ship.state.held
    ship.obeys = False
    ship.sail(120.0)
    assert any(why.startswith('port winch') for why in ship.state.held)


@pytest.mark.parametrize(
    ('limit', 'said'),
    [
        ({'max_tension': 200e3}, ('port warp', '200 kN')),
        ({'max_depth': 110.0}, ('gear below', '110 m')),
        ({'clearance': 895.0}, ('above the seabed', '895 m')),
    ],
)
def test_at_a_limit_it_holds_and_after_a_minute_goes_back(ship, limit, said):
    ship.trial.change(TrialSettings(**limit))
    if 'max_tension' in limit:
        ship.sail(20.0)
        assert not ship.state.held
        ship.tension = 210e3
        assert stands_within(ship)
    else:
        # The gear sinks while warp runs out.
        while not ship.state.held:
            ship.sail(0.5)
        assert not moved(ship, 10.0)
    assert all(part in ship.state.held[0] for part in said)
    ship.sail(60.0)
    assert ship.state.target == TrialTarget(port=300.0, starboard=300.0, speed=2.1)
    # At the highest tension it hauls at a tenth of the speed.
    ship.sail(600.0)
    assert ship.lengths == (300.0, 300.0)
    assert ship.state.struck == 1
    ship.tension = 150e3
    ship.windows(4)
    ship.sail(1.0)
    assert ship.state.target is None or ship.state.target.port != 400.0


def test_the_sounder_that_falls_silent_no_longer_counts(ship):
    ship.silent.add('sounder')
    ship.sail(90.0)
    assert not ship.state.held


def test_the_operator_pauses_vetoes_and_takes_over(ship):
    trial = ship.trial
    trial.pause()
    assert not moved(ship, 20.0)
    assert ship.commands[-1][1] is not None
    assert str(ship.state).startswith('paused')
    trial.resume()
    assert moved(ship, 5.0)
    assert '400 m at 2.10 m/s' in trial.veto()
    ship.sail(1.0)
    assert ship.state.target.port == 500.0
    trial.take_over()
    ship.sail(10.0)
    assert ship.commands[-1][1] is None
    ship.lengths, ship.speed = (350.0, 350.0), 2.0
    ship.sail(10.0)
    trial.resume()
    ship.sail(0.5)
    after = ship.commands[-1][1]
    assert after.port == pytest.approx(350.0, abs=0.5)
    ship.sail(600.0)
    assert ship.lengths == (500.0, 500.0)


def test_what_makes_no_sense_is_refused_with_the_reason(sailing):
    ship = sailing(SETTINGS)
    with pytest.raises(TrawlError, match='veto'):
        ship.trial.veto()
    with pytest.raises(TrawlError, match='paused'):
        ship.trial.resume()


def test_vetoes_leave_the_rest_of_the_proposals(ship):
    for _ in range(3):
        ship.trial.veto()
        ship.sail(1.0)
    assert 'struck off 3' in ship.state.waits
    ship.windows(2, (400.0, 450.0))
    ship.sail(1.0)
    assert ship.state.target.port == 450.0


def test_a_state_without_windows_is_left_and_not_sought_again(ship):
    ship.sail(400.0)
    ship.sail(1.5 * 15.0 * 60.0)
    assert ship.state.target.port == 500.0
    assert ship.state.struck == 1


def test_it_waits_steadily_for_a_slow_adviser(sailing):
    ship = sailing(SETTINGS)
    ship.sail(5.0)
    ship.windows(2, (), advised=1)
    assert not moved(ship, 1800.0)
    assert 'advice' in ship.state.waits
    assert ship.state.hours == pytest.approx(0.5, abs=0.01)
    ship.windows(2)
    ship.sail(1.0)
    assert ship.state.phase == 'transit'


def test_without_new_advice_it_goes_by_the_older_after_ten_minutes(ship):
    ship.sail(400.0)
    ship.windows(4, (), advised=0)
    ship.sail(590.0)
    assert 'advice' in ship.state.waits
    ship.sail(15.0)
    assert (ship.state.phase, str(ship.state.target)) == ('transit', '500 m at 2.10 m/s')


def test_it_ends_when_enough_is_known_or_the_time_is_up(sailing):
    known = {f'law {number}': 0.1 for number in range(8)}
    ship = sailing(TrialSettings(wanted_known=8))
    ship.sail(5.0)
    ship.windows(2, ratios=known, looked_up=1.0)
    ship.sail(1.0)
    assert (ship.state.phase, ship.state.known) == ('done', 8)
    assert ship.commands[-1][1] is None
    ship = sailing(TrialSettings(hours=0.1))
    ship.sail(366.0)
    assert ship.state.phase == 'done'
    ship = sailing(TrialSettings(hours=0.2))
    ship.sail(10.0)
    ship.windows(2)
    ship.sail(1.0)
    assert ship.state.phase == 'done'


def test_killed_and_restarted_it_goes_on(ship, sailing, tmp_path):
    ship.trial.veto()
    ship.sail(30.0)
    path = tmp_path / 'trial.json'
    save_memory(path, ship.trial.memory)
    again = sailing(SETTINGS, load_memory(path), now=ship.now + 60.0, lengths=ship.lengths)
    again.windows(2)
    again.sail(0.5)
    assert again.commands[-1][1] is None
    again.sail(2.0)
    assert again.trial.memory.began_s == ship.trial.memory.began_s
    assert again.state.target.port == 500.0
    assert again.state.struck == 1
    again.sail(600.0)
    assert again.lengths == (500.0, 500.0)
    save_memory(path, again.trial.memory)
    third = sailing(SETTINGS, load_memory(path), now=again.now + 1.0, lengths=(500.0, 500.0))
    third.windows(4)
    third.sail(5.0)
    assert third.state.target.port == 600.0


def test_paused_it_stays_paused_through_a_restart(ship, sailing):
    ship.trial.pause()
    again = sailing(SETTINGS, ship.trial.memory, now=ship.now, lengths=ship.lengths)
    again.sail(3.0)
    assert not moved(again, 30.0)
    again.trial.resume()
    assert moved(again, 5.0)


def test_a_clock_that_begins_anew_begins_the_trial_anew(ship):
    ship.now = 0.0
    ship.sail(10.0)
    assert ship.state.towed == 0
    assert ship.state.hours < 0.01


@pytest.mark.parametrize(
    'text', ['{"phase": "asleep"}', '{}', 'reason: mine', '{"minutes": 5.0, "towed": []}', '']
)
def test_a_file_that_is_no_trial_is_refused_with_its_name(tmp_path, text):
    path = tmp_path / 'trial.json'
    path.write_text(text)
    with pytest.raises(TrawlError, match=r'trial\.json'):
        load_memory(path)


def test_the_heading_is_kept(ship):
    seen = [command.turn_rate for _, command in ship.commands if command is not None]
    assert set(seen) == {0.0}
    stamp = round(ship.now * 1e9)
    ship.trial.take(HeadingSample(stamp, 0.2, 0.002), stamp)
    turn = ship.trial.update(stamp + 250_000_000).turn_rate
    assert turn == pytest.approx(-SETTINGS.max_turn)
