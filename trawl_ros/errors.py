"""What can go wrong, each as one sentence a user can act on.

Every message names the file, key or topic, what was found there and what was expected.
"""

from traceback import format_exception
from typing import Literal

Refusal = Literal['none found', 'collapsed', 'surfaced', 'outside law', 'unstable']
"""Why there is no usable steady state."""


class TrawlError(Exception):
    """Base of all errors that are the input's fault; commands print it and exit with 1."""


class GearError(TrawlError):
    """A gear file that is missing, unreadable or says something impossible."""


class ScenarioError(TrawlError):
    """A scenario file that is missing, unreadable or asks for something impossible."""


class InstrumentError(TrawlError):
    """A file of instrument parameters that is missing, unreadable or impossible."""


class MessageError(TrawlError):
    """A message whose content contradicts what its topic or type promises."""


class BagError(TrawlError):
    """A bag that is missing, damaged, or does not hold what was asked for."""


class LogError(TrawlError):
    """A CSV log or its mapping that cannot be turned into a bag."""


class RosMissing(TrawlError):
    """What needs ROS 2 was asked for where there is none; ``reason`` is the import that failed."""

    def __init__(self, what: str, reason: ImportError) -> None:
        super().__init__(
            f'{what} needs ROS 2 and found no {reason.name}; expected a sourced ROS 2, or the '
            "extra `ros`: pip install 'trawl_ros[ros]'"
        )


class NoSteadyState(TrawlError):
    """The gear has no usable steady state at the wanted warp length and speed.

    ``reason`` says why in a word; where a root was found, which of its faults came first.
    """

    def __init__(self, message: str, reason: Refusal = 'none found') -> None:
        super().__init__(message)
        self.reason: Refusal = reason


def sentence_of(reason: Exception) -> str:
    """What went wrong, for those who cannot let it rise: threads and processes of others.

    An error of the program is told with all that helps to mend it.
    """
    if isinstance(reason, TrawlError):
        return str(reason)
    return f'an error of the program; {"".join(format_exception(reason))}'
