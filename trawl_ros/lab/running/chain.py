# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Simulation, instruments and recorder as processes."""

from collections.abc import Sequence
from pathlib import Path

from trawl_ros.lab.running.processes import Processes, Value

RECORDER, SIMULATION = 'bag_recorder', 'sim_node'
INSTRUMENTS = ('winch_node', 'door_sensor_node', 'trawl_sonar_node', 'vessel_node')
CONSUMERS = (RECORDER, *INSTRUMENTS)
CHAIN = (SIMULATION, *CONSUMERS)

MEGABYTE = 1e6


def chain_parameters(
    node: str, scenario: Path, bag: Path, consumers: Sequence[str] = CONSUMERS
) -> dict[str, Value]:
    """Return the parameters of a node of the chain, which runs at full speed.

    The simulation waits for its consumers.
    """
    if node == RECORDER:
        return {'use_sim_time': True, 'output': str(bag)}
    if node == SIMULATION:
        return {
            'scenario': str(scenario),
            'time_scale': 0.0,
            'publish_clock': True,
            'wait_for': list(consumers),
        }
    return {'use_sim_time': True, 'scenario': str(scenario), 'wait_for': [RECORDER]}


def start_chain(
    processes: Processes,
    scenario: Path,
    bag: Path,
    time_scale: float = 0.0,
    bag_part_s: float | None = None,
) -> None:
    """Start all nodes of the chain on a scenario; the simulation ends with it.

    Parameters
    ----------
    processes
        Runs the nodes.
    scenario, bag
        Of the tow.
    time_scale
        Speed over real time; 0 is as fast as the consumers follow.
    bag_part_s
        Data time after which the recorder begins a new file.
    """
    parts = {} if bag_part_s is None else {'max_bag_duration': bag_part_s}
    more: dict[str, dict[str, Value]] = {
        RECORDER: {**parts},
        SIMULATION: {'time_scale': time_scale, 'exit_at_end': True},
    }
    for node in (*CONSUMERS, SIMULATION):
        processes.start(node, **{**chain_parameters(node, scenario, bag), **more.get(node, {})})


def stop_chain(processes: Processes) -> None:
    """Stop all running nodes of the chain; the recorder is last and gets their last messages.

    Raises
    ------
    NodeFailed
        If one cannot end cleanly.
    """
    left = processes.pids()
    for group in ((SIMULATION,), INSTRUMENTS, (RECORDER,)):
        processes.stop(*(node for node in group if node in left))
