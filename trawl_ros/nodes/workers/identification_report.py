# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Report that an identification ends with: of its windows, and of the whole tow where wanted."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import TrawlError
from trawl_ros.estimation.pipeline import NO_WINDOW, Identification
from trawl_ros.estimation.report.report import Report, report
from trawl_ros.gear.records import GearRecord
from trawl_ros.nodes.workers.motion_learner import MotionLearner

if TYPE_CHECKING:
    from trawl_ros.estimation.motion.outcome import MotionOutcome


class ReportWriter:
    """Writer of the report that an identification ends with.

    Parameters
    ----------
    gear
        The gear as the model has it.
    truth
        Coefficients (q,) that made the data, where they are known.
    folder
        For the report; none is written where None.
    motion
        Learning from the whole tow, where that is wanted.
    """

    def __init__(
        self,
        gear: GearRecord,
        truth: FloatArray | None,
        folder: Path | None,
        motion: MotionLearner | None = None,
    ) -> None:
        self._gear, self._truth, self._folder, self._motion = gear, truth, folder, motion

    def __call__(self, identification: Identification) -> str:
        """Write the report of an identification at rest; the sentence with which all ends.

        The results of the windows are there before the whole tow is fitted.

        Raises
        ------
        TrawlError
            If nothing is estimated, with the reason, or the report cannot be written.
        """
        estimate = identification.estimate
        if estimate is None:
            return self._without_windows(identification)
        refused = '' if self._motion is None else self._motion.refusal()
        outcome = None
        if self._motion is None or refused:
            self._write_of(identification, refused)
        else:
            self._write_of(identification)
            try:
                outcome = self._motion.finish(identification)
            except TrawlError as reason:
                refused = str(reason)
            self._write_of(identification, refused, outcome)
        ends = f'{estimate.windows} windows used; {estimate.reason}'
        if self._folder is not None:
            ends = f'{self._folder}: identification.json of {estimate.windows} windows'
        if outcome is not None:
            return f'{ends} and of {outcome.duration_s / 60:.0f} min of tow'
        return f'{ends}; steady windows alone: {refused}' if refused else ends

    def _write_of(
        self,
        identification: Identification,
        refused: str = '',
        outcome: 'MotionOutcome | None' = None,
    ) -> None:
        if self._folder is not None:
            found = report(identification, self._truth, gear=self._gear, chain=outcome)
            self._write(replace(found, chain_refused=refused))

    def _without_windows(self, identification: Identification) -> str:
        why_not = identification.why_not() or 'nothing is estimated'
        if self._motion is None or not why_not.startswith(NO_WINDOW):
            raise TrawlError(why_not)
        try:
            outcome = self._motion.finish(None)
        except TrawlError as reason:
            raise TrawlError(f'{why_not}; nor in motion: {reason}') from reason
        if self._folder is not None:
            from trawl_ros.estimation.report.report import report_without_windows

            rejections = [identification.finder.rejections]
            self._write(report_without_windows(outcome, rejections, self._gear, self._truth))
        ends = f'{outcome.duration_s / 60:.0f} min of tow used; {outcome.fit.reason}'
        return ends if self._folder is None else f'{self._folder}: {ends}'

    def _write(self, written: Report) -> None:
        assert self._folder is not None
        # Figures bring matplotlib, which the node needs at its end only.
        from trawl_ros.estimation.report.page import write_report

        write_report(written, self._folder)
