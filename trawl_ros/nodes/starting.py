"""Entry points of the nodes: told to end while it is still imported, a node ends without a word.

Imports take seconds, and Python would answer SIGINT with a traceback out of the middle of one.
"""

import os
import signal
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
    main: Callable[[], int] = import_module(f'trawl_ros.nodes.{node}').main
    return main()


def _end(number: int, frame: FrameType | None) -> None:
    # Nothing is open yet, and an exception would be reported by whatever is being imported.
    os._exit(0)


def __getattr__(name: str) -> Callable[[], int]:
    """Give the entry point of a node by its name."""
    if name.startswith('_'):
        raise AttributeError(name)
    return partial(start, name)
