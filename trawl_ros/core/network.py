"""Addresses on which programs of this project listen."""

from ipaddress import ip_address

THIS_MACHINE = '127.0.0.1'
"""Address that nobody from outside reaches: the default of whatever listens."""


def is_this_machine(host: str) -> bool:
    """True if nobody from outside reaches an address."""
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == 'localhost'
