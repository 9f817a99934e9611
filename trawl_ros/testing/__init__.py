# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Pytest plugin for tests of other people's nodes on a towed gear.

It comes with the package. A test asks for the fixture ``trawl_graph`` and opens a graph with it;
`open_graph` is the same as a context manager, for a fixture of a module.
"""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from trawl_ros.testing.graph import Graph, open_graph

__all__ = ['Graph', 'open_graph', 'trawl_graph']


def __getattr__(name: str) -> Any:
    """Load the graph on first use, so that other tests do not load ROS 2."""
    if name not in ('Graph', 'open_graph'):
        raise AttributeError(f'module {__name__} has no attribute {name}')
    from trawl_ros.testing import graph

    return getattr(graph, name)


@pytest.fixture
def trawl_graph() -> Iterator[Callable[..., 'Graph']]:
    """Open graphs by the arguments of `open_graph`; they are closed after the test."""
    pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')
    from trawl_ros.testing.graph import open_graph

    with ExitStack() as stack:
        yield lambda *args, **kwargs: stack.enter_context(open_graph(*args, **kwargs))
