"""One input given to a reader: what went wrong, if anything."""

import faulthandler
import gc
import shutil
import signal
import time
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import FrameType
from typing import Literal

from hostile.target import Files, Reader
from trawl_ros.core.errors import TrawlError

Kind = Literal['crash', 'hang', 'memory', 'overwritten']
KINDS: tuple[Kind, ...] = ('crash', 'hang', 'memory', 'overwritten')

LONGEST_S = 20.0
MOST_BYTES = 2 * 1024**3
_GRACE_S = 15.0
"""How much longer a reader may sit in code that no signal interrupts before it is killed."""


class TookTooLong(BaseException):
    """Not an `Exception`, which a reader may turn into its own."""


@dataclass(frozen=True)
class Fault:
    """What went wrong with an input: its kind and the last lines of what was raised."""

    kind: Kind
    told: str


@dataclass(frozen=True)
class Outcome:
    """Of one trial: the fault, None where all is well; seconds taken and highest memory (bytes)."""

    fault: Fault | None
    took_s: float
    peak_bytes: int


def attempt(read: Reader, files: Files, folder: Path) -> Outcome:
    """Give one input to a reader.

    Parameters
    ----------
    read
        The reader.
    files
        The input.
    folder
        Where it is laid down as ``input/``, with ``results/`` for the reader; emptied before.
    """
    shutil.rmtree(folder, ignore_errors=True)
    given, results = folder / 'input', folder / 'results'
    lay_down(files, given)
    _reset_peak()
    began = time.monotonic()
    fault = None
    try:
        with _limited():
            read(given, results)
    except TrawlError as sentence:
        if _out_of_memory(sentence):
            fault = Fault('memory', _trace(sentence))
    except TookTooLong as late:
        fault = Fault('hang', _trace(late))
    except MemoryError as reason:
        fault = Fault('memory', _trace(reason))
    except BaseException as reason:
        fault = Fault('crash', _trace(reason))
    took, peak = time.monotonic() - began, _peak()
    if fault is None and took > LONGEST_S:
        fault = Fault('hang', f'took {took:.1f} s')
    if fault is None and peak > MOST_BYTES:
        fault = Fault('memory', f'took {peak / 1e9:.1f} GB')
    if fault is None and (changed := _changed(files, given)):
        fault = Fault('overwritten', changed)
    if peak > MOST_BYTES // 4:
        gc.collect()
    return Outcome(fault, took, peak)


def lay_down(files: Files, folder: Path) -> None:
    """Write an input into a folder."""
    folder.mkdir(parents=True)
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)


@contextmanager
def _limited() -> Iterator[None]:
    def late(number: int, frame: FrameType | None) -> None:
        raise TookTooLong

    before = signal.signal(signal.SIGALRM, late)
    faulthandler.dump_traceback_later(LONGEST_S + _GRACE_S, exit=True)
    signal.setitimer(signal.ITIMER_REAL, LONGEST_S)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        faulthandler.cancel_dump_traceback_later()
        signal.signal(signal.SIGALRM, before)


def _changed(files: Files, folder: Path) -> str:
    """Say what a reader did to its input; nothing is expected."""
    found = {path.relative_to(folder).as_posix() for path in folder.rglob('*') if path.is_file()}
    for name in sorted(found ^ files.keys()):
        return f'{name} {"is new" if name in found else "is gone"} beside the input'
    for name, content in files.items():
        if (folder / name).read_bytes() != content:
            return f'{name} is not as it was'
    return ''


def _out_of_memory(reason: BaseException | None) -> bool:
    while reason is not None:
        if isinstance(reason, MemoryError):
            return True
        reason = reason.__cause__ or reason.__context__
    return False


def _trace(reason: BaseException) -> str:
    return ''.join(traceback.format_exception(reason))[-2000:]


def _reset_peak() -> None:
    Path('/proc/self/clear_refs').write_text('5')


def _peak() -> int:
    for line in Path('/proc/self/status').read_text().splitlines():
        if line.startswith('VmHWM:'):
            return int(line.split()[1]) * 1024
    raise OSError('/proc/self/status has no VmHWM')
