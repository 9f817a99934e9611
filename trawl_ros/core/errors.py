# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Errors of the input, each with one sentence that says what to do.

Every message names the file, key or topic, what was found and what was expected.
"""

from traceback import format_exception
from typing import ClassVar, Literal

Refusal = Literal[
    'none found',
    'no balance',
    'fold',
    'lift lost',
    'collapsed',
    'surfaced',
    'outside law',
    'unstable',
]
"""Reasons why there is no usable steady state."""


class TrawlError(Exception):
    """Base class of all input errors; commands print them and exit with 1.

    ``expected`` says what a missing or empty file should be, and how to get one.

    Examples
    --------
    >>> import trawl_ros
    >>> try:
    ...     trawl_ros.load_gear('no_such_gear')
    ... except trawl_ros.TrawlError as reason:
    ...     print(type(reason).__name__)
    GearError
    """

    expected: ClassVar[str] = 'a file with content'


class GearError(TrawlError):
    """Gear file that is missing, unreadable or impossible.

    Examples
    --------
    >>> import trawl_ros
    >>> trawl_ros.load_gear('no_such.yaml')  # doctest: +ELLIPSIS
    Traceback (most recent call last):
        ...
    trawl_ros.core.errors.GearError: no_such.yaml: no such file, expected a gear...
    """

    expected = 'a gear, net plan or door (`trawl files --out FOLDER` copies those of the package)'


class ScenarioError(TrawlError):
    """Scenario file that is missing, unreadable or impossible.

    Examples
    --------
    >>> import trawl_ros
    >>> trawl_ros.load_scenario('no_such.yaml')  # doctest: +ELLIPSIS
    Traceback (most recent call last):
        ...
    trawl_ros.core.errors.ScenarioError: no_such.yaml: no such file, expected a scenario...
    """

    expected = 'a scenario (`trawl files --out FOLDER` copies those of the package)'


class InstrumentError(TrawlError):
    """File of instrument parameters that is missing, unreadable or impossible."""

    expected = 'errors of instruments (`trawl files --out FOLDER` copies those of the package)'


class MessageError(TrawlError):
    """Message with content that contradicts its topic or type."""


class BagError(TrawlError):
    """Bag that is missing, damaged, or without the wanted data.

    Examples
    --------
    >>> import trawl_ros
    >>> trawl_ros.check_bag('no_such_bag')  # doctest: +ELLIPSIS
    Traceback (most recent call last):
        ...
    trawl_ros.core.errors.BagError: no_such_bag: no such bag, expected a folder with...
    """

    expected = 'a folder with metadata.yaml and .mcap or .db3 files, or one such file'


class LogError(TrawlError):
    """CSV log or mapping that cannot be converted to a bag."""

    expected = 'a log, or its mapping (`trawl import-log LOG --draft` writes one)'


class SentenceError(TrawlError):
    """Table of sentences, or its link, that is missing, unreadable or impossible."""

    expected = 'a table of sentences (`trawl files --out FOLDER` copies those of the package)'


class RosMissing(TrawlError):
    """Missing ROS 2 for a function that needs it; ``reason`` is the failed import."""

    def __init__(self, what: str, reason: ImportError) -> None:
        super().__init__(
            f'{what} needs ROS 2 and found no {reason.name}; expected a sourced ROS 2, or the '
            "extra `ros`: pip install 'trawl_ros[ros]'"
        )


class NoSteadyState(TrawlError):
    """Gear without usable steady state at the wanted warp length and speed.

    ``reason`` is the reason in a word; if a root was found, its first fault. ``remedy`` is a
    sentence that names the command for advice, if there is one. Commands, nodes and tracebacks
    print it below the message.

    Examples
    --------
    >>> import trawl_ros
    >>> model = trawl_ros.build_model(trawl_ros.load_gear('kaifuha').refined(net=0.25))
    >>> try:
    ...     trawl_ros.steady_state(model, warp_length=50.0, speed=2.1)
    ... except trawl_ros.NoSteadyState as reason:
    ...     print(f'{reason.reason}: {reason}')
    surfaced: warp 50 m at 2.1 m/s: the gear breaks the surface by 9.3 m
    """

    def __init__(self, message: str, reason: Refusal = 'none found', remedy: str = '') -> None:
        super().__init__(message)
        self.reason: Refusal = reason
        self.remedy = remedy
        if remedy:
            self.add_note(remedy)


def sentence_of(reason: Exception) -> str:
    """Describe an error in a sentence, for threads and processes that cannot raise it.

    A refused tow comes with its remedy, and an error of the program with its traceback.
    """
    if isinstance(reason, NoSteadyState) and reason.remedy:
        return f'{reason}\n{reason.remedy}'
    if isinstance(reason, TrawlError):
        return str(reason)
    return f'an error of the program; {"".join(format_exception(reason))}'
