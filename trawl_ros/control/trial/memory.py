# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Memory of a trial, with which a stopped trial can continue."""

from pathlib import Path

from trawl_ros.control.trial.records import Mode, Phase, TrialTarget
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import write_json
from trawl_ros.core.schema import Record, load_yaml, validated


class TowedState(Record):
    """Towed state, and its number of windows."""

    target: TrialTarget
    windows: int


class TrialMemory(Record):
    """Memory of a trial, with which a stopped trial can continue.

    Attributes
    ----------
    began_s, arrived_s
        Times (s) of the beginning of the trial and of the tow in the present state.
    phase, mode, target
        Values of `TrialState`.
    origin
        State before the target, to which the trial can return.
    heading
        Heading to hold, ENU yaw, rad.
    minutes
        Expected duration of the present state.
    windows_before
        Number of windows on arrival there.
    towed
        States that were towed.
    struck
        Targets struck off by a veto, a limit, or because they gave no windows.
    reason
        Reason for the end of the trial.
    """

    began_s: float | None = None
    arrived_s: float = 0.0
    phase: Phase = 'start'
    mode: Mode = 'sails'
    target: TrialTarget | None = None
    origin: TrialTarget | None = None
    heading: float | None = None
    minutes: float = 0.0
    windows_before: int = 0
    towed: tuple[TowedState, ...] = ()
    struck: tuple[TrialTarget, ...] = ()
    reason: str = ''

    @property
    def last_good(self) -> TrialTarget | None:
        """Last towed state, or the origin if it gave no window."""
        if self.towed and self.towed[-1].windows:
            return self.towed[-1].target
        return self.origin

    def changed(self, **changes: object) -> 'TrialMemory':
        """Return the memory with changed attributes."""
        return self.model_copy(update=changes)

    def heading_for(self, target: TrialTarget, minutes: float) -> 'TrialMemory':
        """Return the memory on the way to a target."""
        return self.changed(phase='transit', origin=self.last_good, target=target, minutes=minutes)

    def arrived(self, now_s: float, minutes: float, windows: int) -> 'TrialMemory':
        """Return the memory on arrival, when the estimator has used this many windows."""
        return self.changed(phase='tow', arrived_s=now_s, minutes=minutes, windows_before=windows)

    def left(self, now_s: float, windows: int) -> 'TrialMemory':
        """Return the memory after the tow at the target, struck off without windows."""
        assert self.target is not None
        state = TowedState(target=self.target, windows=windows)
        struck = self.struck if windows else (*self.struck, self.target)
        return self.changed(
            phase='advice', arrived_s=now_s, towed=(*self.towed, state), struck=struck
        )

    def struck_off(self, now_s: float) -> 'TrialMemory':
        """Return the memory after the target was struck off."""
        struck = (*self.struck, self.target)
        return self.changed(phase='advice', target=None, struck=struck, arrived_s=now_s)


def save_memory(path: Path, memory: TrialMemory) -> None:
    """Save a memory as JSON, completely or not at all.

    Raises
    ------
    TrawlError
        If the file cannot be written.
    """
    write_json(path, memory.model_dump(mode='json'), indent=1)


def load_memory(path: Path) -> TrialMemory:
    """Load a memory.

    Raises
    ------
    TrawlError
        If the file cannot be read, or is not the memory of a trial.
    """
    memory = validated(TrialMemory, load_yaml(path, TrawlError), path, TrawlError)
    # The trial will replace this file, so refuse a foreign one with only some of the keys.
    if missing := sorted(TrialMemory.model_fields.keys() - memory.model_fields_set):
        raise TrawlError(
            f'{path}: found no {missing[0]}, expected the memory of a trial or a new path'
        )
    return memory
