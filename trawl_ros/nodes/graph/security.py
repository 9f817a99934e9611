# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Security of the graph as the environment asks for it, which is never passed over in silence.

ROS 2 reads ``ROS_SECURITY_ENABLE``, ``ROS_SECURITY_STRATEGY`` and ``ROS_SECURITY_KEYSTORE``.
Without the strategy Enforce it goes on in the clear where a key is missing; middleware built
without security plugins, as that of the wheels is, refuses to work with keys.
"""

import os
from collections.abc import Mapping

EXPECTED = (
    'security of this graph is asked for by ROS_SECURITY_ENABLE; expected keys of the enclave '
    'under ROS_SECURITY_KEYSTORE and a ROS 2 whose middleware has security (the packages of pip '
    'have none), or no ROS_SECURITY_ENABLE: docs/guides/security.md'
)

IN_THE_CLEAR = (
    'ROS_SECURITY_ENABLE is set and ROS_SECURITY_STRATEGY is not Enforce: where a key is missing, '
    'ROS 2 goes on in the clear; with Enforce it ends'
)

FINISHING = 'Failed to fini rosout publisher'
"""Beginning of a warning by rclpy when the middleware refuses, apart from the refusal."""


def is_wanted(environment: Mapping[str, str] = os.environ) -> bool:
    """Return whether the environment asks for security, as ROS 2 reads it."""
    return environment.get('ROS_SECURITY_ENABLE') == 'true'


def objection(environment: Mapping[str, str] = os.environ) -> str | None:
    """Return a warning where messages may go in the clear though security is asked for."""
    enforced = environment.get('ROS_SECURITY_STRATEGY') == 'Enforce'
    return IN_THE_CLEAR if is_wanted(environment) and not enforced else None
