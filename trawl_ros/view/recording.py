# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Recording of Rerun that goes to a file or to a viewer."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import new_folder, written
from trawl_ros.view.viewer.rerun_library import rr

APPLICATION = 'trawl_ros'

FLUSH_S = 10.0
"""Time after which a viewer that accepts nothing is abandoned."""


def check_file(path: Path, *, force: bool) -> None:
    """Check, before the work, that a file can be written.

    Raises
    ------
    TrawlError
        If the file exists already and ``force`` does not allow replacing it, or it cannot be
        written.
    """
    if path.is_dir():
        raise TrawlError(f'{path}: is a folder; expected a file such as tow{path.suffix or ".rrd"}')
    if not force:
        new_folder(path, TrawlError)


@contextmanager
def to_file(path: Path, *, force: bool) -> Iterator[rr.RecordingStream]:
    """Write a recording completely or not at all.

    Raises
    ------
    TrawlError
        If the file exists already and ``force`` does not allow replacing it, or it cannot be
        written.
    """
    check_file(path, force=force)
    with written(path) as draft:
        recording = rr.RecordingStream(APPLICATION)
        recording.save(draft)
        try:
            yield recording
        finally:
            recording.flush()
            recording.disconnect()


@contextmanager
def to_viewer(url: str) -> Iterator[rr.RecordingStream]:
    """Send a recording to a viewer."""
    recording = rr.RecordingStream(APPLICATION)
    recording.connect_grpc(url)
    try:
        yield recording
    finally:
        try:
            recording.flush(timeout_sec=FLUSH_S)
        except RuntimeError as reason:
            raise TrawlError(f'{url}: the viewer takes no more ({reason})') from reason
        finally:
            recording.disconnect()
