# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Entry points of the nodes: a node that is to end while it is still imported ends silently.

Imports take seconds, and Python would answer SIGINT with a traceback out of the middle of one.
"""

import os
import signal
import sys
from collections.abc import Callable
from functools import partial
from importlib import import_module
from types import FrameType


def start(node: str) -> int:
    """Import the module of a node, and run it.

    Parameters
    ----------
    node
        Name of its module.

    Returns
    -------
    int
        Exit code.
    """
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, _end)
    try:
        main: Callable[[], int] = import_module(f'trawl_ros.nodes.{node}').main
    except ImportError as reason:
        if not _is_of_ros(reason):
            raise
        from trawl_ros.core.errors import RosMissing

        sys.stderr.write(f'Error: {RosMissing(node, reason)}\n')
        return 1
    return main()


def _is_of_ros(reason: ImportError) -> bool:
    """Return True if rclpy or a package of messages is missing."""
    package = (reason.name or '').partition('.')[0]
    return package == 'rclpy' or package.endswith(('_msgs', '_interfaces', '_srvs'))


def _end(number: int, frame: FrameType | None) -> None:
    # Nothing is open yet, and an exception would be reported by whatever is being imported.
    os._exit(0)


def __getattr__(name: str) -> Callable[[], int]:
    """Give the entry point of a node by its name."""
    if name.startswith('_'):
        raise AttributeError(name)
    return partial(start, name)
