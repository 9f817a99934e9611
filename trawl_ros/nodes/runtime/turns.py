"""Turns of a node's callbacks, so that it works in whatever executor spins it."""

from threading import RLock


class Turns:
    """Turns of a node's callbacks: one at a time, and none after the end.

    A multi-threaded executor may still hold callbacks of a node that is destroyed, and an
    application may set parameters from another thread.
    """

    def __init__(self) -> None:
        self._lock = RLock()
        self._over = False

    def __enter__(self) -> bool:
        """Wait for the turn; False once the node has ended."""
        self._lock.acquire()
        return not self._over

    def __exit__(self, *_: object) -> None:
        self._lock.release()

    def end(self) -> bool:
        """Wait for the callback under way, and refuse all others; True for the first call."""
        with self as first:
            self._over = True
        return first
