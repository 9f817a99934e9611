"""Ctrl-C as a wish that is granted at the next good moment."""

import signal
from types import FrameType, TracebackType

INTERRUPTED = 130
"""Exit code of what was interrupted, by custom of shells."""


class Interruption:
    """While entered, the first SIGINT or SIGTERM is noted and only a second one breaks in.

    So what is being written comes to an end between two messages, not within one.
    """

    def __init__(self) -> None:
        self.requested = False

    def _note(self, number: int, frame: FrameType | None) -> None:
        if self.requested:
            raise KeyboardInterrupt
        self.requested = True

    def __enter__(self) -> 'Interruption':
        self._before = {
            number: signal.signal(number, self._note) for number in (signal.SIGINT, signal.SIGTERM)
        }
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)
