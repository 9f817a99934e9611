# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Addresses and ports on which a viewer is to listen."""

import ipaddress
import socket
from collections.abc import Sequence

from trawl_ros.core.foreign import one_line
from trawl_ros.core.network import THIS_MACHINE
from trawl_ros.view.viewer.process import ViewerFailed


def address_of(bind: str) -> str:
    """Check the address on which a viewer is to listen.

    Raises
    ------
    ViewerFailed
        If it is none.
    """
    try:
        return str(ipaddress.ip_address(bind))
    except ValueError:
        raise ViewerFailed(
            f'--bind {one_line(bind, 60)}: expected an IP address such as {THIS_MACHINE}, this '
            'machine alone, or 0.0.0.0, everybody who reaches it'
        ) from None


def family_of(bind: str) -> socket.AddressFamily:
    """Family of an address."""
    return socket.AF_INET if ipaddress.ip_address(bind).version == 4 else socket.AF_INET6


def reached(bind: str) -> str:
    """Host name by which this machine reaches an address on which it listens."""
    address = ipaddress.ip_address(bind)
    if not address.is_unspecified:
        return bind
    return THIS_MACHINE if address.version == 4 else '::1'


def in_url(host: str) -> str:
    """Host in the form of a URL."""
    return f'[{host}]' if ':' in host else host


def two_ports(bind: str, wanted: int | None) -> tuple[int, int]:
    """Find two free ports; if the first one is given, the second one is the next.

    Raises
    ------
    ViewerFailed
        If the wanted ones are taken.
    """
    asked: Sequence[int] = (0, 0) if wanted is None else (wanted, wanted + 1)
    ears = []
    try:
        for port in asked:
            ear = socket.socket(family_of(bind), socket.SOCK_STREAM)
            ears.append(ear)
            ear.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            try:
                ear.bind((bind, port))
            except OSError as reason:
                raise ViewerFailed(
                    f'{bind} port {port}: cannot be listened on ({reason.strerror}); expected an '
                    'address of this machine and a free port'
                ) from reason
        page, data = (ear.getsockname()[1] for ear in ears)
        return page, data
    finally:
        for ear in ears:
            ear.close()
