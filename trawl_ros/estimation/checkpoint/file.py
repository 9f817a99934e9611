# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Checkpoint of a running identification in one file, from which it can be resumed.

The file is a zip archive without compression: ``state.json`` and the numbers of all arrays in
``numbers.bin``, each with a checksum. It holds windows, linearisations with the shapes that the
solver starts from, counts and context, so that continuing gives what would have come without
the interruption.
"""

import json
import os
import struct
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import written
from trawl_ros.core.foreign import open_file
from trawl_ros.core.validation_messages import shown
from trawl_ros.core.version import __version__
from trawl_ros.estimation.checkpoint.packing import Packer, Unpacker
from trawl_ros.estimation.pipeline import Identification
from trawl_ros.gear.records import GearRecord
from trawl_ros.records.channels import CHANNELS

WHAT = 'state of an identification'
FORMAT = 1

MAX_BYTES = 500_000_000
"""Some thousand windows of a gear in full detail."""

JSON, NUMBERS = 'state.json', 'numbers.bin'

DAMAGE = (zipfile.BadZipFile, zlib.error, struct.error)
"""Exceptions of damaged archives besides Python's own."""


class CheckpointError(TrawlError):
    """Checkpoint file that is missing, damaged, too large or of something else."""


def save_checkpoint(path: Path, identification: Identification, gear: GearRecord) -> None:
    """Save a checkpoint; an existing one is replaced atomically.

    Parameters
    ----------
    path
        The file.
    identification
        Between two samples.
    gear
        It was built for.

    Raises
    ------
    StateError
        If it cannot be written or has grown too large.
    """
    packer = Packer(identification.estimator.predictor)
    record = {
        'what': WHAT,
        'format': FORMAT,
        'version': __version__,
        'settings': _settings(identification, gear),
        'identification': packer.pack(identification),
    }
    text = json.dumps(record).encode()
    if len(text) + len(packer.numbers) > MAX_BYTES:
        raise CheckpointError(
            f'{path}: {len(identification.estimator.windows)} windows take more than '
            f'{MAX_BYTES / 1e6:g} MB and are not saved'
        )
    try:
        with written(path) as draft, draft.open('wb') as stream:
            with zipfile.ZipFile(stream, 'w') as archive:
                archive.writestr(JSON, text)
                archive.writestr(NUMBERS, bytes(packer.numbers))
            stream.flush()
            # Renamed before its content is on the disk, it could be empty after a power cut.
            os.fsync(stream.fileno())
    except TrawlError as reason:
        raise CheckpointError(f'the state is not saved: {reason}') from reason


def load_checkpoint(path: Path, fresh: Identification, gear: GearRecord) -> Identification:
    """Load a checkpoint.

    Parameters
    ----------
    path
        The file.
    fresh
        An identification as built for this gear, which lends its model.
    gear
        It was built for.

    Returns
    -------
    Identification
        It goes on where the saved one was.

    Raises
    ------
    StateError
        If the file is missing, damaged, too large, of another version of the program, or of
        another gear or other settings.
    """
    text, numbers = _read(path)
    unfit = f'{path}: found no undamaged {WHAT}'
    try:
        record = json.loads(text)
        if record['what'] != WHAT:
            raise CheckpointError(unfit)
        made_by = record['format'], record['version']
    except (LookupError, TypeError, ValueError, RecursionError) as reason:
        raise CheckpointError(f'{unfit} ({reason})') from reason
    if made_by != (FORMAT, __version__):
        raise CheckpointError(
            f'{path}: the state is of format {made_by[0]} by version {made_by[1]}, expected '
            f'format {FORMAT} by version {__version__}'
        )
    packer = Packer(fresh.estimator.predictor)
    packer.pack(fresh)
    settings = json.loads(json.dumps(_settings(fresh, gear)))
    for difference in _differences(record.get('settings'), settings):
        raise CheckpointError(f'{path}: the state is of an identification with {difference}')
    try:
        identification = Unpacker(numbers, packer).unpack(record['identification'])
    except (LookupError, TypeError, ValueError, AttributeError, RecursionError) as reason:
        raise CheckpointError(f'{unfit} of this version ({reason})') from reason
    if not isinstance(identification, Identification):
        raise CheckpointError(unfit)
    return identification


def _read(path: Path) -> tuple[bytes, bytes]:
    try:
        with open_file(path, CheckpointError) as file, zipfile.ZipFile(file) as archive:
            members = [archive.getinfo(name) for name in (JSON, NUMBERS)]
            size = sum(member.file_size for member in members)
            if size > MAX_BYTES:
                raise CheckpointError(
                    f'{path}: the state takes {size / 1e6:.0f} MB, expected at most '
                    f'{MAX_BYTES / 1e6:g} MB'
                )
            text, numbers = (archive.read(member) for member in members)
    except OSError as reason:
        raise CheckpointError(f'{path}: the state cannot be read ({reason.strerror})') from reason
    except (*DAMAGE, LookupError, ValueError, EOFError, RuntimeError) as reason:
        raise CheckpointError(f'{path}: found no undamaged {WHAT} ({reason})') from reason
    return text, numbers


def _settings(identification: Identification, gear: GearRecord) -> dict[str, Any]:
    """Settings without which a checkpoint is invalid: another gear makes other windows."""
    return {
        'gear': gear.model_dump(mode='json'),
        'windows': asdict(identification.window_options),
        'estimator': asdict(identification.estimator.options),
        'channels': {name: asdict(channel) for name, channel in CHANNELS.items()},
    }


def _differences(saved: Any, expected: Any, key: str = '') -> Iterator[str]:
    """Yield the differences of settings, as 'key found, expected expected'."""
    if isinstance(saved, Mapping) and isinstance(expected, Mapping):
        for name in dict.fromkeys((*expected, *saved)):
            below = f'{key}.{name}' if key else name
            yield from _differences(saved.get(name), expected.get(name), below)
    elif saved != expected:
        yield f'{key or "settings"} {shown(saved)}, expected {shown(expected)}'
