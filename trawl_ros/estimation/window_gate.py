# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Window gate: checks of a window by all channels and its tow, before it reaches the estimate."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.screening import Screening, without
from trawl_ros.estimation.windows.over_ground import OverGround
from trawl_ros.estimation.windows.records import RejectedWindow, Rejections, SteadyWindow

if TYPE_CHECKING:
    from trawl_ros.solver.equilibrium import Equilibrium


@dataclass(frozen=True)
class GatedWindow:
    """Verdict of the gate: a window to be used, or None and the reason.

    ``near`` is a steady state to start from. ``withdraw``: what was found holds for the whole tow,
    also for its windows in the estimate.
    """

    window: SteadyWindow | None
    rejected: RejectedWindow | None = None
    withdraw: bool = False
    near: 'Equilibrium | None' = None


class WindowGate:
    """Window gate: judges windows by all of their channels and by their tow.

    Parameters
    ----------
    screening
        Of units and plausibility, by the model.
    """

    def __init__(self, screening: Screening) -> None:
        self._screening = screening
        self.reset()

    def reset(self) -> None:
        """Reset to no windows."""
        self.rejections = Rejections()
        self._over_ground = OverGround()
        self._screening.reset()

    def judge(self, window: SteadyWindow, coefficients: FloatArray) -> GatedWindow:
        """Judge a window, by the model at the present coefficients (q,)."""
        over_ground = self._over_ground.judge(window.tow, window.track)
        if over_ground is not None:
            return self._refuse(window, 'speed over ground', over_ground, withdraw=True)
        judgement = self._screening.judge(window, coefficients)
        if judgement.found is None:
            return GatedWindow(window, near=self._screening.near)
        reason, detail = judgement.found.reason, judgement.found.detail
        if judgement.refused:
            return self._refuse(window, reason, detail, withdraw=reason == 'wrong unit')
        self.rejections.add(reason, detail)
        return GatedWindow(without(window, judgement.without), near=self._screening.near)

    def _refuse(
        self, window: SteadyWindow, reason: str, detail: str, *, withdraw: bool
    ) -> GatedWindow:
        self.rejections.add(reason, detail)
        rejected = RejectedWindow(reason, window.start_ns, window.end_ns, detail)
        return GatedWindow(None, rejected, withdraw)
