# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Separate ROS domain, so that two demos at the same time do not receive each other's messages."""

import random
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from trawl_ros.core.errors import TrawlError

DOMAINS = (*range(20, 70), *range(215, 233))
"""Neither ROS's own 0 nor those whose ports Linux also gives to outgoing connections."""

FIRST_PORT, PORTS_PER_DOMAIN = 7410, 250
"""Of discovery, in UDP: the first participant of domain d is at the first port + 250 d (RTPS 2.5,
9.6.2)."""


@contextmanager
def own_graph(logs: Path) -> Iterator[dict[str, str]]:
    """Yield the environment of an isolated graph: this machine only, a free domain.

    The domain is held until the context is left, or the process ends, however it does.

    Raises
    ------
    TrawlError
        If all domains are in use.
    """
    # Not in order: who cannot see who holds a domain, as from another container, may yet hear it.
    for domain in random.SystemRandom().sample(DOMAINS, len(DOMAINS)):
        # An abstract address: no file is left, and the kernel takes it back with the process. It
        # is as wide as the network is, which is how far ROS 2 hears.
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as held:
            if _binds(held, f'\0trawl_ros-domain-{domain}') and _silent(domain):
                yield {
                    'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
                    'ROS_DOMAIN_ID': str(domain),
                    'ROS_LOG_DIR': str(logs.resolve()),
                }
                return
    raise TrawlError(
        f'ROS domains {DOMAINS[0]} to {DOMAINS[-1]}: all in use, expected a free one; end some of '
        'the demos and studies that run'
    )


def _silent(domain: int) -> bool:
    """True if the discovery port of the domain's first participant is free."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as port:
        return _binds(port, ('', FIRST_PORT + PORTS_PER_DOMAIN * domain))


def _binds(ear: socket.socket, address: str | tuple[str, int]) -> bool:
    try:
        ear.bind(address)
    except OSError:
        return False
    return True
