# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Subscriber that waits for the first message on a topic."""

import time
from typing import Any

import rclpy
from rclpy.executors import SingleThreadedExecutor

from trawl_ros.messages.diagnostics import read_statuses
from trawl_ros.nodes.graph.discovery import announce_often
from trawl_ros.nodes.runtime.connected_node import DIAGNOSTICS
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.qos import CONSUMER

AT_REST_S = 0.5
"""Time for running nodes to discover the subscriber."""


class FirstMessage:
    """Subscriber while entered, a participant of its own that has seen no earlier node.

    It announces itself as the nodes of the package do.

    Parameters
    ----------
    domain
        ROS domain.
    node
        Name of the node; on /diagnostics only what it says of itself counts.
    topic
        Relative to the namespace of the project.
    """

    def __init__(self, domain: int, node: str, topic: str) -> None:
        self._domain, self._node, self._topic = domain, node, topic
        self._at: float | None = None

    def __enter__(self) -> 'FirstMessage':
        announce_often()
        self._context = rclpy.Context()
        rclpy.init(args=[], context=self._context, domain_id=self._domain)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._listener = TrawlNode('ear', context=self._context)
        handler = self._heard_of if self._topic == DIAGNOSTICS else self._heard
        self._listener.listen(self._topic, handler, CONSUMER)
        self._executor.add_node(self._listener)
        end = time.monotonic() + AT_REST_S
        while time.monotonic() < end:
            self.spin(0.05)
        return self

    def __exit__(self, *_: object) -> None:
        self._executor.remove_node(self._listener)
        self._listener.destroy_node()
        self._executor.shutdown()
        rclpy.try_shutdown(context=self._context)

    def _heard(self, message: Any) -> None:
        if self._at is None:
            self._at = time.perf_counter()

    def _heard_of(self, message: Any) -> None:
        if any(status.hardware_id == self._node for status in read_statuses(message)):
            self._heard(message)

    def spin(self, timeout_s: float) -> float | None:
        """Return the time of arrival (s, of `time.perf_counter`); None before it."""
        self._executor.spin_once(timeout_sec=timeout_s)
        return self._at
