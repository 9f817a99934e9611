# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Addresses and names on which programs of the project listen."""

import ipaddress
import socket
from urllib.parse import urlsplit

THIS_MACHINE = '127.0.0.1'
"""Loopback address, the default of all servers."""


def is_this_machine(host: str) -> bool:
    """Return True for a loopback address."""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == 'localhost'


def is_own_name(text: str, listens_at: str) -> bool:
    """Return True if ``HOST:PORT`` of a client is an address or a name of this machine.

    This refuses foreign names that resolve to this machine (DNS rebinding).
    """
    host = _host_of(f'//{text}')
    own = socket.gethostname().lower()
    if host in ('localhost', listens_at.lower(), own, f'{own}.local'):
        return True
    return _is_address(host)


def is_own_origin(origin: str) -> bool:
    """Return True if an origin, such as ``http://localhost:8080``, is a page of this machine."""
    return is_this_machine(_host_of(origin))


def _host_of(url: str) -> str:
    try:
        return urlsplit(url).hostname or ''
    except ValueError:
        return ''


def _is_address(host: str) -> bool:
    try:
        ipaddress.ip_address(host)
    except ValueError:
        return False
    return True
