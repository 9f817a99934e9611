# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Watch over the commands to a ship: stamps of another time, and a commander who falls silent."""

from trawl_ros.core.errors import MessageError
from trawl_ros.core.time import SECOND
from trawl_ros.nodes.runtime.parameters import Number

MAX_AGE = Number(
    'max_command_age_s', 0.0, 's', 0.0, 1e6, 'Largest difference between the stamp of a command '
    'and the time of this node; others are refused; 0 takes any stamp.', live=True,
)  # fmt: skip
"""Parameter of nodes that hear commands."""


class CommandWatch:
    """Watch over one topic of commands.

    Parameters
    ----------
    topic
        For what is said.

    Attributes
    ----------
    lapsed : bool
        True from the end of the longest silence to the next command.
    """

    def __init__(self, topic: str) -> None:
        self._topic = topic
        self._heard_s: float | None = None
        self.lapsed = False

    def take(self, stamp: int, now: int, time_s: float, max_age_s: float) -> None:
        """Register a command.

        Parameters
        ----------
        stamp
            Of its header, ns; 0 is none.
        now
            Time of the node, ns.
        time_s
            Simulated time, s.
        max_age_s
            Largest difference (s) of stamp and ``now``; 0 allows any.

        Raises
        ------
        MessageError
            If the stamp differs by more.
        """
        age_s = (now - stamp) / SECOND
        if stamp and max_age_s and abs(age_s) > max_age_s:
            side = 'before' if age_s > 0.0 else 'after'
            raise MessageError(
                f'{self._topic}: stamped {abs(age_s):.1f} s {side} the time of this node; expected '
                f'at most {max_age_s:g} s (parameter max_command_age_s), or no stamp'
            )
        self._heard_s, self.lapsed = time_s, False

    def lapses(self, time_s: float, timeout_s: float) -> bool:
        """True once, when the topic has been silent for longer than a time (s); 0 is never."""
        if not timeout_s or self.lapsed or self._heard_s is None:
            return False
        self.lapsed = time_s - self._heard_s > timeout_s
        return self.lapsed
