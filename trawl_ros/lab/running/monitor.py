# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Monitor of a running graph: the nodes' diagnostics, and requests to them."""

import os
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from threading import Lock, Thread
from typing import Any, TypeVar

import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.logging import LoggingSeverity
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger

from trawl_ros.messages.diagnostics import read_statuses
from trawl_ros.nodes.identification_node import FINISH
from trawl_ros.nodes.runtime.connected_node import DIAGNOSTICS
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.qos import CONSUMER
from trawl_ros.records.topics import NAMESPACE, absolute

PUBLISHED = 'published '
MESSAGES = 'messages'


@dataclass
class Heard:
    """Newest values of each status, by node and by the subsystem's name."""

    values: dict[tuple[str, str], Mapping[str, str]] = field(default_factory=dict)
    lock: Lock = field(default_factory=Lock)

    def take(self, message: Any) -> None:
        """Update by a message on ``/diagnostics``."""
        with self.lock:
            for status in read_statuses(message):
                subsystem = status.name.rpartition(': ')[2]
                self.values[status.hardware_id, subsystem] = status.values

    def get(self, node: str, subsystem: str, key: str) -> str:
        """Return a value, '' if it was not heard yet."""
        with self.lock:
            return self.values.get((node, subsystem), {}).get(key, '')


MonitorT = TypeVar('MonitorT', bound='Monitor')


class Monitor:
    """Monitor of a graph in a thread of its own while entered.

    Parameters
    ----------
    environment
        Environment variables of the graph's nodes, such as ``ROS_DOMAIN_ID``.
    """

    NAME = 'monitor'
    """Of its node."""

    def __init__(self, environment: Mapping[str, str]) -> None:
        self._environment = environment
        self._heard = Heard()

    def value(self, node: str, subsystem: str, key: str) -> str:
        """Return a value of a node's diagnostics, '' if it was not heard yet."""
        return self._heard.get(node, subsystem, key)

    def published(self) -> dict[str, int]:
        """Return the number of messages by full topic name, as the publishers count them."""
        found: dict[str, int] = {}
        with self._heard.lock:
            for (_, subsystem), values in self._heard.values.items():
                if subsystem != MESSAGES:
                    continue
                for key, value in values.items():
                    if key.startswith(PUBLISHED):
                        topic = key.removeprefix(PUBLISHED)
                        found[topic] = found.get(topic, 0) + int(value)
        return found

    def finish_identification(self, waiting: Callable[[], None]) -> tuple[bool, str]:
        """Request `identification_node` to finish.

        Parameters
        ----------
        waiting
            Called again and again meanwhile; what it raises ends the wait.

        Returns
        -------
        success, message
            As the service answers.
        """
        client = self._node.create_client(Trigger, absolute(FINISH))
        while not client.service_is_ready():
            waiting()
            time.sleep(0.1)
        answer: Any = client.call_async(Trigger.Request())
        while not answer.done():
            waiting()
            time.sleep(0.1)
        response = answer.result()
        return response.success, response.message

    def listen_to_more(self, node: TrawlNode) -> None:
        """Subscribe to more than diagnostics, before the monitor is spun."""

    def __enter__(self: MonitorT) -> MonitorT:
        self._before = {key: os.environ.get(key) for key in self._environment}
        os.environ.update(self._environment)
        self._context = Context()
        rclpy.init(args=[], context=self._context)
        # Recorded with the others, its diagnostics must lie in their time.
        in_simulated_time = Parameter('use_sim_time', value=True)
        self._node = TrawlNode(
            self.NAME,
            namespace=NAMESPACE,
            context=self._context,
            parameter_overrides=[in_simulated_time],
        )
        # Its remarks on clocks and types are in the logs of the nodes themselves.
        self._node.get_logger().set_level(LoggingSeverity.FATAL)
        self._node.listen(DIAGNOSTICS, self._heard.take, CONSUMER)
        self.listen_to_more(self._node)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._over = False
        self._thread = Thread(target=self._spin, name='monitor', daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._over = True
        self._thread.join()
        self._node.destroy_node()
        self._executor.shutdown()
        self._context.try_shutdown()
        for key, value in self._before.items():
            if value is None:
                os.environ.pop(key, None)
            else:
                os.environ[key] = value

    def _spin(self) -> None:
        while not self._over:
            self._executor.spin_once(timeout_sec=0.1)
