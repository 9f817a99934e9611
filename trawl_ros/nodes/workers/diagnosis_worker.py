# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Worker thread that diagnoses a tow in progress."""

from collections.abc import Callable
from dataclasses import dataclass
from threading import Lock

from trawl_ros.core.errors import sentence_of
from trawl_ros.diagnosis.diagnosis import Diagnosis
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.nodes.workers.worker import Worker

Windows = tuple[SteadyWindow, ...]


@dataclass(frozen=True)
class DiagnosisOutcome:
    """Result of a diagnosis of the newest windows, or its error."""

    diagnosis: Diagnosis | None = None
    trouble: str = ''


class DiagnosisWorker(Worker[Windows]):
    """Worker thread that diagnoses all windows so far; of several queued sets the newest counts.

    Parameters
    ----------
    diagnose
        From windows to a diagnosis.
    on_outcome
        Called in this thread after each diagnosis, unless its windows were forgotten meanwhile.
    """

    def __init__(
        self,
        diagnose: Callable[[Windows], Diagnosis],
        on_outcome: Callable[[DiagnosisOutcome], None],
    ) -> None:
        super().__init__('diagnosis')
        self._diagnose = diagnose
        self._on_outcome = on_outcome
        self._handing_over = Lock()
        self._newest: Windows | None = None
        self._forgotten = 0

    def look_at(self, windows: Windows) -> None:
        """Hand over all windows so far."""
        with self._handing_over:
            self._newest = windows
        self.put(windows)

    def forget(self) -> None:
        """Discard the windows that were handed over before."""
        with self._handing_over:
            self._newest = None
            self._forgotten += 1

    def do(self, work: Windows) -> None:
        """Diagnose the windows unless newer ones are queued."""
        with self._handing_over:
            if work is not self._newest:
                return
            forgotten = self._forgotten
        try:
            outcome = DiagnosisOutcome(self._diagnose(work))
        except Exception as reason:
            outcome = DiagnosisOutcome(trouble=sentence_of(reason))
        with self._handing_over:
            if forgotten == self._forgotten:
                self._on_outcome(outcome)
