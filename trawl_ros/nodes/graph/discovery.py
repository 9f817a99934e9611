# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Discovery of nodes by each other: Fast DDS announces a node more often than by default."""

import os
from collections.abc import MutableMapping
from contextlib import suppress
from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as version_of
from pathlib import Path

from trawl_ros.core.resources import share_path

VARIABLES = ('FASTDDS_DEFAULT_PROFILES_FILE', 'FASTRTPS_DEFAULT_PROFILES_FILE')
"""Of Fast DDS 3 (Kilted and later) and of Fast DDS 2 (Jazzy), which knows only its own."""

FIRST_RCLPY_OF_FAST_DDS_3 = 8

FILES = ('DEFAULT_FASTDDS_PROFILES.xml', 'DEFAULT_FASTRTPS_PROFILES.xml')
"""Profiles that Fast DDS takes from the working directory."""


def announce_often(
    environment: MutableMapping[str, str] = os.environ, folder: Path | None = None
) -> None:
    """Name the package's profile to Fast DDS, unless the user has one; before ROS is up.

    Without it, half of the nodes that start together were heard of 3 s later than the rest:
    that is the period in which one that runs already announces itself again, where its answer to
    the newcomer was lost.

    Parameters
    ----------
    environment
        Variables of this process.
    folder
        The working directory.
    """
    here = folder or Path()
    if any(name in environment for name in VARIABLES) or any(
        (here / name).exists() for name in FILES
    ):
        return
    profile = str(share_path('config', 'dds', 'announcements.xml'))
    environment.update(dict.fromkeys(variables(_rclpy_version()), profile))


def variables(version: str) -> tuple[str, ...]:
    """Return the variables that the Fast DDS of a version of rclpy reads without a warning.

    Both are returned for a version that is not known.
    """
    major = version.partition('.')[0]
    if not major.isdigit():
        return VARIABLES
    return VARIABLES[:1] if int(major) >= FIRST_RCLPY_OF_FAST_DDS_3 else VARIABLES[1:]


def _rclpy_version() -> str:
    # A full ROS 2 calls it rclpy, the package index ros-rclpy.
    for name in ('rclpy', 'ros-rclpy'):
        with suppress(PackageNotFoundError):
            return version_of(name)
    return ''
