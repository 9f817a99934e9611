"""Errors of the input, each as one sentence a user can act on.

Every message names the file, key or topic, what was found there and what was expected.
"""

from traceback import format_exception
from typing import Literal

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
    """Base class of all errors of the input; commands print them and exit with 1.

    Examples
    --------
    >>> import trawl_ros
    >>> try:
    ...     trawl_ros.load_gear('no_such_gear')
    ... except trawl_ros.TrawlError as reason:
    ...     print(type(reason).__name__)
    GearError
    """


class GearError(TrawlError):
    """Gear file that is missing, unreadable or says something impossible.

    Examples
    --------
    >>> import trawl_ros
    >>> trawl_ros.load_gear('no_such.yaml')
    Traceback (most recent call last):
        ...
    trawl_ros.core.errors.GearError: no_such.yaml: no such file
    """


class ScenarioError(TrawlError):
    """Scenario file that is missing, unreadable or asks for something impossible.

    Examples
    --------
    >>> import trawl_ros
    >>> trawl_ros.load_scenario('no_such.yaml')
    Traceback (most recent call last):
        ...
    trawl_ros.core.errors.ScenarioError: no_such.yaml: no such file
    """


class InstrumentError(TrawlError):
    """File of instrument parameters that is missing, unreadable or impossible."""


class MessageError(TrawlError):
    """Message whose content contradicts its topic or type."""


class BagError(TrawlError):
    """Bag that is missing, damaged, or does not hold what was asked for.

    Examples
    --------
    >>> import trawl_ros
    >>> trawl_ros.check_bag('no_such_bag')
    Traceback (most recent call last):
        ...
    trawl_ros.core.errors.BagError: no_such_bag: no such bag
    """


class LogError(TrawlError):
    """CSV log or mapping that cannot be turned into a bag."""


class SentenceError(TrawlError):
    """Table of sentences, or link for them, that is missing, unreadable or impossible."""


class RosMissing(TrawlError):
    """Missing ROS 2 for a function that needs it; ``reason`` is the import that failed."""

    def __init__(self, what: str, reason: ImportError) -> None:
        super().__init__(
            f'{what} needs ROS 2 and found no {reason.name}; expected a sourced ROS 2, or the '
            "extra `ros`: pip install 'trawl_ros[ros]'"
        )


class NoSteadyState(TrawlError):
    """Gear without usable steady state at the wanted warp length and speed.

    ``reason`` says why in a word; where a root was found, which of its faults came first. Where a
    command computes what would help, ``remedy`` names it in a sentence; commands, nodes and, from
    Python 3.11 on, tracebacks tell it below the message.

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
            self.__notes__ = [remedy]


def sentence_of(reason: Exception) -> str:
    """Describe an error in a sentence, for threads and processes that cannot let it rise.

    A refused tow is told with what would help, an error of the program with all that helps to mend
    it.
    """
    if isinstance(reason, NoSteadyState) and reason.remedy:
        return f'{reason}\n{reason.remedy}'
    if isinstance(reason, TrawlError):
        return str(reason)
    return f'an error of the program; {"".join(format_exception(reason))}'
