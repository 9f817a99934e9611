# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Diagnosis of a gear: verdict, evidence, and the repair where there is one."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.diagnosis.holdout import HoldoutComparison, Split
from trawl_ros.diagnosis.inference.decision import NamedCause, Verdict
from trawl_ros.diagnosis.inference.posterior import Explanation, Posterior
from trawl_ros.diagnosis.inference.refit import Refit
from trawl_ros.diagnosis.inference.screen import Screen
from trawl_ros.diagnosis.instruments import FrozenSensor
from trawl_ros.diagnosis.locating import Where
from trawl_ros.diagnosis.next_tow import Proposal
from trawl_ros.diagnosis.predictive_check import QuantityOnHoldout
from trawl_ros.gear.records import GearRecord

if TYPE_CHECKING:
    from trawl_ros.diagnosis.onset.tows import OnsetsInTow


@dataclass(frozen=True)
class BoardsMoved:
    """How far the fitted boards are from those of the gear file.

    ``std`` is the largest departure of a coefficient, in std of the prior, ``coefficient`` its
    name; ``spread`` and ``depth`` (m) are the mean changes of door spread and door depth by it.
    """

    std: float
    coefficient: str
    spread: float
    depth: float


@dataclass(frozen=True)
class Diagnosis:
    """Diagnosis of a gear.

    Attributes
    ----------
    verdict, reason
        And why.
    gear
        As it was believed.
    tows
        Their names.
    baseline
        Those in which nothing was looked for.
    split
        Windows kept back in the comparison of errors, and the others; all of them decide.
    base, screen, posterior
        Boards alone; all hypotheses to first order; their probabilities. None where it did not
        come to that.
    named, among
        Leaves and nodes that are named; leaves that are not excluded.
    best
        Explanation whose sizes are given: of what is named, or else the likeliest.
    moved
        How far the boards moved from the gear file.
    where, holdout, held_out
        Patterns of residuals; errors on what was kept back, by channel and by quantity.
    remarks
        On instruments that need no model to be seen at fault.
    frozen
        Sensors that show one value throughout a tow, whose readings were left out.
    checks, proposals
        Next steps where causes cannot be separated: without towing, in sentences, and
        tows.
    onsets
        Onsets in the tows; empty where that was not asked for.

    Examples
    --------
    >>> import trawl_ros
    >>> diagnosis = trawl_ros.diagnose(['tow_1'], gear='coarse.yaml')
    >>> diagnosis.tows, diagnosis.posterior is None
    (('tow_1',), True)
    """

    verdict: Verdict
    reason: str
    gear: GearRecord
    tows: tuple[str, ...]
    baseline: frozenset[int]
    split: Split
    base: Refit | None = None
    screen: Screen | None = None
    posterior: Posterior | None = None
    named: tuple[NamedCause, ...] = ()
    among: tuple[str, ...] = ()
    best: Explanation | None = None
    moved: BoardsMoved | None = None
    where: tuple[Where, ...] = ()
    holdout: HoldoutComparison | None = None
    held_out: tuple[QuantityOnHoldout, ...] = ()
    remarks: tuple[str, ...] = ()
    frozen: tuple[FrozenSensor, ...] = ()
    checks: tuple[str, ...] = ()
    proposals: tuple[Proposal, ...] = ()
    onsets: 'tuple[OnsetsInTow, ...]' = ()

    @property
    def repair(self) -> Explanation | None:
        """Repair of the gear: the explanation that is named."""
        return self.best if self.verdict == 'NAMED' else None

    def lowered(self, explanation: Explanation) -> tuple[float, float]:
        """Return by how much a refitted explanation lowers χ² and BIC of the boards alone."""
        assert self.base is not None
        assert self.screen is not None
        assert explanation.refit is not None
        scales = self.screen.fit.scales
        delta = 2.0 * (self.base.cost(scales) - explanation.refit.cost(scales))
        readings = sum(len(linear.channels) for linear in self.screen.fit.windows)
        return delta, delta - explanation.refit.number * float(np.log(readings))


def unread(gear: GearRecord, tows: Sequence[str], reason: str) -> Diagnosis:
    """Return the diagnosis of recordings without a single steady window."""
    nothing = Split((), (), 'state')
    return Diagnosis('NOT_TESTABLE', reason, gear, tuple(tows), frozenset(), nothing)


def values_of(best: Explanation) -> Mapping[str, Mapping[str, tuple[float, float, float, str]]]:
    """Return cause → parameter → value, both ends of its interval, and unit."""
    by_cause: dict[str, dict[str, tuple[float, float, float, str]]] = {}
    assert best.refit is not None
    estimate = best.refit.estimate
    blocks = best.refit.fit.prior.blocks('effect')
    for suspect, block in zip(best.suspects, blocks, strict=True):
        own = by_cause.setdefault(suspect.entry.name, {})
        parameters = suspect.entry.effect.parameters
        for parameter, place in zip(parameters, block, strict=True):
            numbers = (estimate.values[place], estimate.low[place], estimate.high[place])
            value, low, high = map(float, numbers)
            own[parameter.name] = (value, low, high, parameter.unit)
    return by_cause
