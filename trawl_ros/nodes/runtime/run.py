# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Runtime of a node: from the command line to a spinning node and to a clean end."""

import logging
import os
import re
import signal
import sys
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from traceback import walk_tb
from types import FrameType

import rclpy
from rclpy.exceptions import ROSInterruptException
from rclpy.executors import Executor, ExternalShutdownException, SingleThreadedExecutor
from rclpy.logging import LoggingSeverity, get_logger, get_logger_level, set_logger_level
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import remove_ros_args

from trawl_ros.core.errors import TrawlError, sentence_of
from trawl_ros.core.first_start import COMPILATION, LOG, need_home
from trawl_ros.core.foreign import short
from trawl_ros.nodes.graph import security
from trawl_ros.nodes.graph.discovery import announce_often
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.parameters import misspelt

try:
    # Takes a message in a tenth of the time, since it makes no list of all that it waits for.
    from rclpy.experimental import EventsExecutor as NodeExecutor
except ImportError:
    NodeExecutor = SingleThreadedExecutor

WAKE_S = 0.1
"""Python sees a signal only between two waits, so no wait is longer than this."""

QUIET_S = 0.3
LONGEST_DRAIN_S = 5.0

SOURCE_PLACES = re.compile(r',?( at)? /project/\S+:\d+')
"""Places in the sources of ROS 2, which are of no use to a reader."""

TAKEN = 'expected arguments and environment as it takes them'

REFUSAL_WIDTH = 400
"""Signs of what ROS 2 says, which may hold the path of a file."""


class _StopSignals:
    """Counter of SIGINT and SIGTERM while entered."""

    def __init__(self) -> None:
        self.wishes = 0

    def _note(self, number: int, frame: FrameType | None) -> None:
        self.wishes += 1

    def __enter__(self) -> '_StopSignals':
        self._before = {
            number: signal.signal(number, self._note) for number in (signal.SIGINT, signal.SIGTERM)
        }
        return self

    def __exit__(self, *_: object) -> None:
        for number, handler in self._before.items():
            # Asked to end, the process is leaving: a second signal must not make that unclean.
            signal.signal(number, signal.SIG_IGN if self.wishes else handler)


class _RosLog(logging.Handler):
    """Handler that passes records on to the log of ROS."""

    def emit(self, record: logging.LogRecord) -> None:
        get_logger(record.name).info(record.getMessage())


def run(make: Callable[[], TrawlNode], args: Sequence[str] | None = None) -> int:
    """Spin a node until SIGINT, SIGTERM, or until it has come to its end by itself.

    Parameters
    ----------
    make
        Creates the node once ROS is up.
    args
        Command line with the program's name first; by default that of the process.

    Returns
    -------
    int
        Exit code: 0, or 1 after one sentence on stderr.
    """
    arguments = list(sys.argv if args is None else args)
    program = Path(arguments[0]).name if arguments else 'trawl_ros'
    LOG.addHandler(_RosLog())
    # A node whose first step compiles could not end before, for a minute.
    with _StopSignals() as stop, COMPILATION.stopping(lambda: stop.wishes > 0):
        try:
            _open_ros(arguments)
            unknown = remove_ros_args(arguments)[1:]
            if unknown:
                raise TrawlError(
                    f'{" ".join(unknown)}: not understood; expected parameters such as '
                    '--ros-args -p name:=value'
                )
            return _spin(make, stop)
        except TrawlError as reason:
            print(f'{program}: {sentence_of(reason)}', file=sys.stderr)  # noqa: T201
            return 1
        except SystemExit as reason:
            said = f'code of another package ended the node (exit {reason.code})'
            print(f'{program}: {said}', file=sys.stderr)  # noqa: T201
            return 1
        except (ExternalShutdownException, ROSInterruptException, KeyboardInterrupt):
            return 0
        finally:
            rclpy.try_shutdown()


def _open_ros(arguments: Sequence[str]) -> None:
    announce_often()
    # ROS 2 refuses to start where its log cannot be written to, but not without a log file.
    own = need_home() or bool({'ROS_LOG_DIR', 'ROS_HOME'} & os.environ.keys())
    without_log = [] if own else ['--ros-args', '--disable-external-lib-logs']
    # Its log of wrong arguments is raised as well.
    set_logger_level('rcl', LoggingSeverity.FATAL)
    try:
        with _refusals():
            # ROS's own handlers would close the context before the last words are said.
            rclpy.init(
                args=[*arguments, *without_log], signal_handler_options=SignalHandlerOptions.NO
            )
    finally:
        if get_logger_level('rcl') == LoggingSeverity.FATAL:
            set_logger_level('rcl', LoggingSeverity.UNSET)


@contextmanager
def _refusals() -> Iterator[None]:
    """Convert errors of ROS 2 at the start, of arguments and environment, into a sentence."""
    try:
        yield
    except Exception as reason:
        *_, (frame, _) = walk_tb(reason.__traceback__)
        # Its classes have no base in common; what the project's own code raises is a mistake there.
        if not frame.f_globals['__name__'].startswith('rclpy'):
            raise
        refusal = SOURCE_PLACES.sub('', short(reason, REFUSAL_WIDTH))
        # It has no words for an enclave without keys.
        refusal = refusal.replace(': error not set', '').rstrip('.')
        expected = security.EXPECTED if security.is_wanted() else TAKEN
        raise TrawlError(f'ROS 2 refuses to start: {refusal}; {expected}') from reason


def _spin(make: Callable[[], TrawlNode], stop: _StopSignals) -> int:
    with _refusals(), warnings.catch_warnings():
        warnings.filterwarnings('ignore', message=security.FINISHING)
        node = make()
    node.introduce()
    for sentence in (*misspelt(node), security.objection()):
        if sentence:
            node.get_logger().warning(sentence)
    executor = NodeExecutor()
    executor.add_node(node)
    try:
        while not stop.wishes and node.exit_code is None:
            executor.spin_once(timeout_sec=WAKE_S)
        # After a failure, as at a full disk, messages under way would only fail as well.
        if node.DRAINS and not node.exit_code:
            _drain(executor, node, stop)
    finally:
        node.destroy_node()
        executor.shutdown()
    return node.exit_code or 0


def _drain(executor: Executor, node: TrawlNode, stop: _StopSignals) -> None:
    """Process messages on their way, until none come or patience ends, or by a second signal."""
    wishes = stop.wishes
    end = time.monotonic() + LONGEST_DRAIN_S
    received, since = -1, time.monotonic()
    while time.monotonic() < end and stop.wishes == wishes:
        executor.spin_once(timeout_sec=0.05)
        if node.traffic.total('received') != received:
            received, since = node.traffic.total('received'), time.monotonic()
        elif time.monotonic() - since > QUIET_S:
            break
