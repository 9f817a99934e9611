"""Commands of a ship expire: a commander who is gone or of another time does not steer her."""

import math

import numpy as np
import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from trawl_ros.core.errors import MessageError  # noqa: E402
from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.effects.effect_set import effects_of  # noqa: E402
from trawl_ros.gear.records import EffectRecord  # noqa: E402
from trawl_ros.messages.commands import vessel_command, winch_command  # noqa: E402
from trawl_ros.messages.diagnostics import OK, WARN  # noqa: E402
from trawl_ros.model.gear_model import build_model  # noqa: E402
from trawl_ros.nodes.autotrawl_node import AutotrawlNode  # noqa: E402
from trawl_ros.nodes.command_watch import CommandWatch  # noqa: E402
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.nodes.sim_node import SimNode  # noqa: E402
from trawl_ros.nodes.towing import CommandedTow  # noqa: E402
from trawl_ros.nodes.winch_node import WinchNode  # noqa: E402
from trawl_ros.simulation.command import Command  # noqa: E402

pytestmark = pytest.mark.ros

TIMEOUT_S = 3.0
RATE = math.radians(1.0)


@pytest.fixture
def tow(graph, gear_path):
    """A simulation and a commander."""

    def begin(**parameters):
        simulation = graph.add(SimNode, gear=str(gear_path), time_scale=5.0, **parameters)
        commander = graph.add(lambda **kwargs: TrawlNode('commander', **kwargs))
        for topic in ('command/winch', 'command/vessel'):
            commander.advertise(topic)
        graph.until(lambda: all(matched for matched, _ in commander.subscribers().values()))
        graph.until(lambda: simulation._tow.time_s > 1.0)
        return simulation, commander

    return begin


def run(graph, simulation, seconds):
    end = simulation._tow.time_s + seconds
    graph.until(lambda: simulation._tow.time_s >= end, 60.0)


def command(simulation):
    return simulation._tow.simulation.command


def test_a_ship_whose_commander_is_gone_goes_straight_on_and_her_winches_stop(graph, tow):
    simulation, commander = tow(command_timeout_s=TIMEOUT_S)
    commander.send(*vessel_command(0, 2.1, RATE))
    commander.send(*winch_command(0, 700.0, 650.0))
    graph.until(lambda: command(simulation).port_length == 700.0)
    graph.remove(commander)
    run(graph, simulation, TIMEOUT_S + 0.5)
    assert command(simulation).turn_rate == 0.0
    assert command(simulation).speed == 2.1
    # From 0.31 m/s a winch stops in 4.9 s.
    run(graph, simulation, 6.0)
    winches = simulation._tow.simulation.now.winches
    lengths = [winch.length for winch in winches]
    assert all(winch.speed == 0.0 for winch in winches)
    assert all(500.0 < length < 530.0 for length in lengths)
    run(graph, simulation, 2.0)
    assert [winch.length for winch in simulation._tow.simulation.now.winches] == lengths
    (status,) = simulation.statuses()
    assert status.level == WARN
    assert 'command/vessel and command/winch' in status.message


def test_who_commands_again_is_obeyed_and_topics_are_watched_apart(graph, tow):
    simulation, commander = tow(command_timeout_s=TIMEOUT_S)
    commander.send(*vessel_command(0, 2.1, RATE))
    commander.send(*winch_command(0, 510.0, 510.0))
    run(graph, simulation, 1.0)
    for _ in range(5):
        commander.send(*winch_command(0, 510.0, 510.0))
        run(graph, simulation, 1.0)
    assert command(simulation).turn_rate == 0.0
    assert command(simulation).port_length == 510.0
    commander.send(*vessel_command(0, 2.1, -RATE))
    graph.until(lambda: command(simulation).turn_rate == -RATE)
    assert simulation.statuses()[0].level == OK


def test_winches_that_are_commanded_in_a_scenario_stop_too(graph, scenario_path):
    simulation = graph.add(
        SimNode, scenario=str(scenario_path), winches='command', time_scale=5.0,
        command_timeout_s=TIMEOUT_S,
    )  # fmt: skip
    graph.command_winches(350.0, 300.0)
    graph.until(lambda: simulation._watches['command/winch'].lapsed, 60.0)
    run(graph, simulation, 6.0)
    port, _ = simulation._tow.simulation.now.winches
    assert port.speed == 0.0
    assert 300.5 < port.length < 305.0


def test_without_the_parameter_a_command_holds(graph, tow):
    simulation, commander = tow()
    commander.send(*vessel_command(0, 2.1, RATE))
    run(graph, simulation, 12.0)
    assert command(simulation).turn_rate == RATE


@pytest.mark.parametrize(
    ('stamp_s', 'words'), [(7200, 'max_command_age_s'), (0, None), (None, None)]
)
def test_a_stamp_of_another_time_is_refused_and_told(graph, tow, stamp_s, words):
    simulation, commander = tow(max_command_age_s=5.0)
    now = simulation.now()
    stamp = now if stamp_s is None else stamp_s * SECOND
    commander.send(*vessel_command(stamp, 2.2, 0.0))
    if words is None:
        graph.until(lambda: command(simulation).speed == 2.2)
        return
    graph.until(lambda: words in simulation.all_statuses()[0].message)
    assert 'max_command_age_s' in simulation.all_statuses()[0].message
    assert command(simulation).speed == 2.0


def test_controllers_of_the_project_are_within_the_age(graph, gear_path):
    graph.add(WinchNode, gear=str(gear_path), use_sim_time=True)
    simulation = graph.add(
        SimNode, gear=str(gear_path), time_scale=2.0, max_command_age_s=5.0, command_timeout_s=5.0
    )
    graph.add(AutotrawlNode, mode='lengths', port_length_m=505.0, use_sim_time=True)
    graph.until(lambda: simulation._tow.simulation.now.winches[0].length > 504.0, 60.0)
    assert simulation.traffic.total('refused') == 0


@pytest.mark.parametrize('field', ['velocity', 'effort'])
def test_a_speed_or_a_tension_in_place_of_a_length_is_named(graph, tow, field):
    simulation, commander = tow()
    topic, message = winch_command(0, 500.0, 500.0)
    setattr(message, field, np.array([0.5, 0.5]))
    message.position = np.zeros(0)
    commander.send(topic, message)
    reason = f'{field} 0.5 of port_warp without a position'
    graph.until(lambda: reason in simulation.all_statuses()[0].message)


def test_a_speed_beside_a_length_is_said_to_be_unused(graph, tow, capfd):
    simulation, commander = tow()
    topic, message = winch_command(0, 505.0, 505.0)
    message.velocity = np.array([0.5, 0.5])
    commander.send(topic, message)
    graph.until(lambda: command(simulation).port_length == 505.0)
    assert 'velocity of command/winch' in capfd.readouterr().err


def test_a_speed_beside_a_length_is_kept_where_it_is_to_be_honoured(graph, tow):
    simulation, commander = tow(winch_velocity='honoured')
    topic, message = winch_command(0, 505.0, 505.0)
    message.velocity = np.array([0.2, 0.0])
    commander.send(topic, message)
    graph.until(lambda: simulation._tow.simulation.now.winches[1].length > 504.0)
    port, starboard = simulation._tow.simulation.now.winches
    assert command(simulation).winch_speeds == (0.2, math.inf)
    assert port.speed <= 0.2 + 1e-12
    assert port.length < starboard.length - 1.0
    # The next command has no speed, and the winch runs as fast as it can.
    commander.send(*winch_command(0, 505.0, 505.0))
    graph.until(lambda: command(simulation).winch_speeds == (math.inf, math.inf))


def test_a_speed_beside_a_length_is_refused_by_name_where_it_is_to_be(graph, tow):
    simulation, commander = tow(winch_velocity='refused')
    topic, message = winch_command(0, 505.0, 505.0)
    message.velocity = np.array([0.5, 0.5])
    commander.send(topic, message)
    graph.until(lambda: 'winch_velocity' in simulation.all_statuses()[0].message)
    assert command(simulation).port_length == 500.0


def test_winches_that_stop_do_not_creep_though_their_counters_err(gear):
    gear = gear.model_copy(
        update={
            'netting': gear.netting.model_copy(update={'around': 12}),
            'effects': (EffectRecord(name='counter_scale', values={'scale': 0.03}),),
        }
    )
    tow = CommandedTow(
        build_model(gear), Command(500.0, 500.0, 2.1), heading=0.0, truth_rate_hz=10.0,
        effect_set=effects_of(gear),
    )  # fmt: skip
    tow.command_winches(600.0, None)
    for _ in range(60):
        tow.step()
    length = tow.simulation.now.winches[0].length
    tow.command_winches(*tow.simulation.stop_lengths())
    for _ in range(60):
        tow.step()
    port, starboard = tow.simulation.now.winches
    assert port.speed == starboard.speed == 0.0
    assert length < port.length < length + 2.0
    assert tow.simulation.command.starboard_length == 500.0


def test_a_watch_lapses_once_and_not_before_the_first_command():
    watch = CommandWatch('command/vessel')
    assert not watch.lapses(100.0, 5.0)
    watch.take(0, 50 * SECOND, 100.0, 0.0)
    assert not watch.lapses(104.9, 5.0)
    assert not watch.lapses(200.0, 0.0)
    assert [watch.lapses(time_s, 5.0) for time_s in (105.1, 105.2)] == [True, False]
    with pytest.raises(MessageError, match=r'49\.0 s before .* 5 s'):
        watch.take(SECOND, 50 * SECOND, 106.0, 5.0)
    assert watch.lapsed
