"""A subscriber that waits for the first message on a topic."""

import time
from types import TracebackType
from typing import Any

import rclpy
from rclpy.executors import SingleThreadedExecutor

from trawl_ros.messages.diagnostics import read_statuses
from trawl_ros.nodes.node import DIAGNOSTICS, TrawlNode
from trawl_ros.nodes.qos import CONSUMER


class Ear:
    """Listens on a ROS domain of its own while entered.

    Parameters
    ----------
    domain
        Its number.
    """

    def __init__(self, domain: int) -> None:
        self._domain = domain

    def __enter__(self) -> 'Ear':
        self._context = rclpy.Context()
        rclpy.init(args=[], context=self._context, domain_id=self._domain)
        self._executor = SingleThreadedExecutor(context=self._context)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._executor.shutdown()
        rclpy.try_shutdown(context=self._context)

    def waiting_for(self, node: str, topic: str) -> 'FirstMessage':
        """Subscribe to a topic; on /diagnostics only what ``node`` says of itself counts."""
        return FirstMessage(self._context, self._executor, node, topic)


class FirstMessage:
    """The first message of a topic since this was made."""

    def __init__(
        self, context: Any, executor: SingleThreadedExecutor, node: str, topic: str
    ) -> None:
        self._executor, self._node = executor, node
        self._at: float | None = None
        self._listener = TrawlNode(f'ear_{time.monotonic_ns()}', context=context)
        handler = self._heard_of if topic == DIAGNOSTICS else self._heard
        self._listener.listen(topic, handler, CONSUMER)
        executor.add_node(self._listener)

    def _heard(self, message: Any) -> None:
        if self._at is None:
            self._at = time.perf_counter()

    def _heard_of(self, message: Any) -> None:
        if any(status.hardware_id == self._node for status in read_statuses(message)):
            self._heard(message)

    def spin(self, timeout_s: float) -> float | None:
        """When it came (s, of `time.perf_counter`); None while it has not."""
        self._executor.spin_once(timeout_sec=timeout_s)
        return self._at

    def close(self) -> None:
        """Listen no longer."""
        self._executor.remove_node(self._listener)
        self._listener.destroy_node()
