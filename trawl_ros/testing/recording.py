# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Recordings of topics in a test."""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.time import SECOND
from trawl_ros.messages.stamps import stamp_of


class Recording:
    """Messages of a topic, in the order in which they came.

    Parameters
    ----------
    topic
        Full name of the topic.
    silence
        Returns the reason why a topic may be silent.

    Attributes
    ----------
    messages : list
        Messages with the fields of their ROS type; arrays are NumPy arrays.
    """

    def __init__(self, topic: str, silence: Callable[[str], str]) -> None:
        self.topic = topic
        self.messages: list[Any] = []
        self._silence = silence

    def __len__(self) -> int:
        return len(self.messages)

    @property
    def latest(self) -> Any:
        """The newest message."""
        return self._heard()[-1]

    @property
    def times(self) -> FloatArray:
        """Stamps of the headers, shape (n,), s."""
        return np.array([stamp_of(message) / SECOND for message in self._heard()])

    def values(self, get: Callable[[Any], float | Iterable[float]], since_s: float = 0.0) -> Any:
        """Return a quantity of all messages from a time on.

        Parameters
        ----------
        get
            Returns a number, or k numbers, from a message.
        since_s
            Earliest stamp, s.

        Returns
        -------
        array
            Shape (n,) or (n, k).

        Raises
        ------
        AssertionError
            If nothing was heard since then.
        """
        chosen = [m for m in self._heard() if not since_s or stamp_of(m) >= since_s * SECOND]
        if not chosen:
            raise AssertionError(
                f'{self.topic}: nothing since {since_s:g} s; the latest of {len(self)} messages is '
                f'of {self.times[-1]:g} s'
            )
        return np.array([get(message) for message in chosen], dtype=float)

    def explanation(self) -> str:
        """Say why nothing was heard."""
        return f'{self.topic}: nothing heard; {self._silence(self.topic)}'

    def _heard(self) -> list[Any]:
        if not self.messages:
            raise AssertionError(self.explanation())
        return self.messages
