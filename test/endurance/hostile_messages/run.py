"""Study of hostile messages: every subscription of every node, each node in this process."""

import json
import socket
import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Thread
from typing import Any

import numpy as np
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.logging import LoggingSeverity
from rclpy.parameter import Parameter

from endurance.hostile_messages.attack import (
    PATIENCE_S,
    Attack,
    AttackTally,
    Stream,
    examples_of,
)
from endurance.long_tow import write_coarse_gear, write_long_tow
from trawl_ros.core.network import THIS_MACHINE
from trawl_ros.core.progress import OnProgress, ignore, step_counter
from trawl_ros.core.resources import share_path
from trawl_ros.estimation.fit.estimate import Estimate
from trawl_ros.lab.running.own_graph import own_graph
from trawl_ros.messages.cdr import serialize
from trawl_ros.messages.commands import fault_command, vessel_command, winch_command
from trawl_ros.messages.diagnostics import OK, Status, diagnostic_array
from trawl_ros.messages.estimates import (
    ChannelInnovation,
    covariance_message,
    estimate_message,
    innovation_message,
)
from trawl_ros.messages.pieces import TopicMessage
from trawl_ros.messages.stamps import header
from trawl_ros.messages.truth_to_messages import clock_message
from trawl_ros.nodes.autopilot_node import AutopilotNode
from trawl_ros.nodes.autotrawl_node import AutotrawlNode
from trawl_ros.nodes.bag_player import BagPlayer
from trawl_ros.nodes.bag_recorder import BagRecorder
from trawl_ros.nodes.discrepancy_node import FINDINGS, DiscrepancyNode
from trawl_ros.nodes.door_sensor_node import DoorSensorNode
from trawl_ros.nodes.foxglove_node import FoxgloveNode
from trawl_ros.nodes.identification_node import STATUS, IdentificationNode
from trawl_ros.nodes.nmea_in import NmeaIn
from trawl_ros.nodes.nmea_out import NmeaOut
from trawl_ros.nodes.runtime.connected_node import DIAGNOSTICS
from trawl_ros.nodes.runtime.credit import HEADER
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.sim_node import SimNode
from trawl_ros.nodes.trawl_sonar_node import TrawlSonarNode
from trawl_ros.nodes.trial_node import STATUS as TRIAL_STATUS
from trawl_ros.nodes.trial_node import TrialNode
from trawl_ros.nodes.vessel_node import VesselNode
from trawl_ros.nodes.view_node import ViewNode
from trawl_ros.nodes.winch_node import WinchNode
from trawl_ros.records.topics import SYNC, absolute
from trawl_ros.scenario.recording import recorded_messages
from trawl_ros.scenario.run import Trial
from trawl_ros.scenario.scenario import load_scenario

MINUTES = 8.0
"""Length of the sound tow."""

SHARE = 0.05
"""Hostile messages per sound one, where an estimate is made."""

MOST_MOVED = 0.3
"""Standard deviations by which an estimate may move without a word."""

QUICK = {'settle_s': 0.0, 'settle_passages': 0.0, 'window_s': 20.0}
"""Windows such as a short tow has."""

PROTOCOL = 'foxglove.sdk.v1'

Kind = Callable[..., TrawlNode]


@dataclass(frozen=True)
class Moved:
    """Shift of an estimate by hostile messages.

    ``shift`` is the largest change of a coefficient in standard deviations of the undisturbed
    estimate, NaN where one of both is missing; ``told`` is how many messages were refused or
    readings rejected beyond those of the undisturbed tow, of ``sent`` hostile ones.
    """

    shift: float
    told: int
    sent: int
    windows: tuple[int, int]


@dataclass(frozen=True)
class AttackResults:
    """Result of all attacks."""

    tallies: tuple[AttackTally, ...]
    moved: Moved


def run_hostile(
    count: int, seed: int, on_progress: OnProgress = ignore, minutes: float = MINUTES
) -> AttackResults:
    """Attack each node with its part of a number of messages.

    Parameters
    ----------
    count
        Hostile messages, over all nodes.
    seed
        Of all draws.
    on_progress
        Called after each node.
    minutes
        Length of the sound tow of which they are made.
    """
    with TemporaryDirectory() as name, _context(Path(name) / 'log') as context:
        folder = Path(name)
        gear = write_coarse_gear(folder, 'kaifuha')
        stream = sound_stream(folder, gear, minutes)
        examples = examples_of(stream)
        tallies = []
        kinds = _nodes(folder, gear)
        # The nodes, and the estimate.
        step = step_counter('attacking', len(kinds) + 1, on_progress)
        for number, (kind, parameters) in enumerate(kinds):
            with (
                _running(context, kind, parameters) as (node, executor),
                _viewer(node, executor, sorted(examples)),
            ):
                attack = Attack(node, executor, stream, seed + number)
                attack.feed_sound()
                attack.feed_hostile(examples, -(-count // len(kinds)))
                if not attack.tally.ended:
                    attack.tally.answers = attack.feed_until_answered()
                tallies.append(attack.tally)
            step()
        moved = _moved(context, gear, stream, seed)
        step()
    return AttackResults(tuple(tallies), moved)


def sound_stream(folder: Path, gear: str, minutes: float) -> Stream:
    """Tow for a while; give all messages as they would be sent, with clock and commands."""
    scenario = load_scenario(write_long_tow(folder, gear, minutes / 60.0))
    found: list[tuple[str, str, bytes]] = []
    for stamp, messages in recorded_messages(Trial(scenario)):
        others = [
            clock_message(stamp),
            winch_command(stamp, 380.0, 380.0),
            vessel_command(stamp, 2.0, 0.0),
            (SYNC, header(stamp, 'bag_recorder')),
            fault_command('door/spread', 'none'),
            *_estimates(stamp),
        ]
        for topic, message in (*others, *messages):
            type_name = HEADER if topic == SYNC else message.__msgtype__
            found.append((absolute(topic), type_name, serialize(message)))
    return found


def _estimates(stamp: int) -> list[TopicMessage]:
    """Give what the recorder hears besides: estimates, findings and the trial's status."""
    statuses = diagnostic_array(stamp, [Status('coefficients', OK, 'estimating', {'a1': '1.19'})])
    return [
        estimate_message(np.ones(12)),
        covariance_message(np.eye(12)),
        innovation_message(stamp, [ChannelInnovation('door_spread', 0.1, 0.3, 0.3)]),
        *((name, statuses) for name in (STATUS, FINDINGS, TRIAL_STATUS, DIAGNOSTICS)),
    ]


def free_port() -> int:
    """Return a TCP port of this machine at which nobody listens."""
    with socket.socket() as probe:
        probe.bind((THIS_MACHINE, 0))
        port: int = probe.getsockname()[1]
    return port


def _nodes(folder: Path, gear: str) -> list[tuple[Kind, dict[str, Any]]]:
    by_gear = {'gear': gear, 'use_sim_time': True}
    instruments = (WinchNode, DoorSensorNode, TrawlSonarNode, VesselNode)
    return [
        (SimNode, {'gear': gear, 'time_scale': 1.0}),
        *((kind, by_gear) for kind in instruments),
        (AutotrawlNode, {'mode': 'tension', 'use_sim_time': True}),
        (AutopilotNode, {'mode': 'heading', 'use_sim_time': True}),
        (BagRecorder, {'output': str(folder / 'bag'), 'use_sim_time': True}),
        (IdentificationNode, by_gear | {'advise': False}),
        (DiscrepancyNode, by_gear),
        (TrialNode, by_gear),
        (NmeaIn, {'links': [f'udp://:{free_port()}'], 'systems': ['set_points'], 'commands': True}),
        (NmeaOut, {'links': [f'udp://:{free_port()}'], 'use_sim_time': True}),
        # Of topics that have no gaps in the bag, which would be published as NaN.
        (
            BagPlayer,
            {
                'bag': str(share_path('bags', 'sea_trial')),
                'topics': ['winch/joint_states'],
                'loop': True,
            },
        ),
        *_viewers(folder),
    ]


def _viewers(folder: Path) -> Iterator[tuple[Kind, dict[str, Any]]]:
    """Give the nodes for viewers, as far as their libraries are installed."""
    if find_spec('websockets'):
        yield FoxgloveNode, {'port': free_port(), 'use_sim_time': True}
    if find_spec('rerun'):
        output = {'viewer': 'headless', 'output': str(folder / 'tow.rrd')}
        yield ViewNode, output | {'use_sim_time': True}


@contextmanager
def _viewer(node: Any, executor: SingleThreadedExecutor, topics: list[str]) -> Iterator[None]:
    """Be a viewer of `foxglove_node`, which then listens to topics; others need none."""
    if not isinstance(node, FoxgloveNode):
        yield
        return
    from websockets.sync.client import connect
    from websockets.typing import Subprotocol

    url = f'ws://{THIS_MACHINE}:{node.parameters["port"]}'
    with connect(url, subprotocols=[Subprotocol(PROTOCOL)], max_size=None) as line:
        # Read what is passed on and throw it away.
        Thread(target=lambda: deque(line, 0), daemon=True).start()
        wishes = [
            {'id': number, 'channelId': number + 1}
            for number, topic in enumerate(node._topics)
            if topic in topics
        ]
        line.send(json.dumps({'op': 'subscribe', 'subscriptions': wishes}))
        end = time.monotonic() + PATIENCE_S
        while len(node._heard) < len(wishes) and time.monotonic() < end:
            executor.spin_once(timeout_sec=0.05)
        yield


def _moved(context: Context, gear: str, stream: Stream, seed: int) -> Moved:
    found: list[tuple[Estimate | None, int, int]] = []
    for share in (0.0, SHARE):
        parameters = {'gear': gear, 'use_sim_time': True, 'advise': False, **QUICK}
        with _running(context, IdentificationNode, parameters) as (node, executor):
            attack = Attack(node, executor, stream, seed)
            attack.feed_mixed(share)
            node.finish_work()
            outcome = node._worker.outcome
            refusals = node.traffic.total('refused') + sum(outcome.rejected.values())
            found.append((outcome.estimate, refusals, sum(attack.tally.sent.values())))
    (calm, before, _), (stormy, after, sent) = found
    windows = (calm.windows if calm else 0, stormy.windows if stormy else 0)
    shift = float('nan')
    if calm and stormy:
        deviations = np.sqrt(np.diag(calm.covariance))
        shift = float(np.max(np.abs(stormy.values - calm.values) / deviations))
    return Moved(shift, after - before, sent, windows)


@contextmanager
def _context(logs: Path) -> Iterator[Context]:
    with own_graph(logs) as graph:
        context = Context()
        rclpy.init(args=[], context=context, domain_id=int(graph['ROS_DOMAIN_ID']))
        try:
            yield context
        finally:
            context.try_shutdown()


@contextmanager
def _running(
    context: Context, kind: Kind, parameters: dict[str, Any]
) -> Iterator[tuple[Any, SingleThreadedExecutor]]:
    overrides = [Parameter(name, value=value) for name, value in parameters.items()]
    node = kind(context=context, parameter_overrides=overrides)
    # It says each new reason, and here there are thousands.
    node.get_logger().set_level(LoggingSeverity.FATAL)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    try:
        yield node, executor
    finally:
        executor.remove_node(node)
        node.destroy_node()
        executor.shutdown()
