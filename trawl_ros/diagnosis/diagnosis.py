"""Diagnosis of a gear: verdict, evidence, and the repair where there is one."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from trawl_ros.diagnosis.empirical import Empirical
from trawl_ros.diagnosis.holdout import HoldoutComparison, Split
from trawl_ros.diagnosis.instruments import FrozenSensor
from trawl_ros.diagnosis.locating import Where
from trawl_ros.diagnosis.mimicry import Mimic
from trawl_ros.diagnosis.naming import Named
from trawl_ros.diagnosis.next_tow import Proposal
from trawl_ros.diagnosis.refit import Refit
from trawl_ros.diagnosis.rules import Verdict
from trawl_ros.diagnosis.score_test import ScoreTest
from trawl_ros.diagnosis.weighing import Weighed
from trawl_ros.gear.records import GearRecord

if TYPE_CHECKING:
    from trawl_ros.diagnosis.onset.tows import OnsetsInTow


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
        Windows that decided, and those kept back.
    base, score_test, named, where, holdout
        Boards alone; test for effects; naming; patterns and jumps of residuals; errors on what was
        kept back. None, or empty, where it did not come to that.
    remarks
        On instruments that need no model to be seen at fault.
    frozen
        Sensors that show one value throughout a tow, whose readings were left out.
    checks, proposals
        Next steps where something cannot be told apart: without towing, in sentences, and
        tows.
    empirical
        The term that explains what no effect does, where there is one.
    mimics
        Changes of the gear file that explain as much as the best effect, or where nothing is named
        more; the likeliest first.
    onsets
        Onsets in the tows; empty where that was not asked for.

    Examples
    --------
    >>> import trawl_ros
    >>> diagnosis = trawl_ros.diagnose(['tow_1'], gear='coarse.yaml')
    >>> diagnosis.tows, diagnosis.named is None
    (('tow_1',), True)
    """

    verdict: Verdict
    reason: str
    gear: GearRecord
    tows: tuple[str, ...]
    baseline: frozenset[int]
    split: Split
    base: Refit | None = None
    score_test: ScoreTest | None = None
    named: Named | None = None
    where: tuple[Where, ...] = ()
    holdout: HoldoutComparison | None = None
    remarks: tuple[str, ...] = ()
    frozen: tuple[FrozenSensor, ...] = ()
    checks: tuple[str, ...] = ()
    proposals: tuple[Proposal, ...] = ()
    empirical: Empirical | None = None
    mimics: tuple[Mimic, ...] = ()
    onsets: 'tuple[OnsetsInTow, ...]' = ()

    @property
    def best(self) -> Weighed | None:
        """The best effect, or two, where something was detected and refitted."""
        return self.named.weighed[0] if self.named and self.named.weighed else None

    @property
    def added(self) -> Weighed | None:
        """Addition to the boards' refit: an empirical term, or else the best effect."""
        return self.best if self.empirical is None else self.empirical.weighed

    @property
    def added_as(self) -> str:
        """Designation of the addition in sentences."""
        return 'the effect' if self.empirical is None else 'the empirical term'

    @property
    def repair(self) -> Weighed | None:
        """Repair of the gear: the effect that is named, or an empirical term."""
        return self.added if self.empirical or self.verdict == 'NAMED' else None


def unread(gear: GearRecord, tows: Sequence[str], reason: str) -> Diagnosis:
    """The diagnosis of recordings without a single steady window."""
    nothing = Split((), (), 'state')
    return Diagnosis('NOT_TESTABLE', reason, gear, tuple(tows), frozenset(), nothing)


def values_of(refit: Refit) -> Mapping[str, Mapping[str, tuple[float, float, float, str]]]:
    """Effect → parameter → value, both ends of its interval, and unit."""
    by_effect: dict[str, dict[str, tuple[float, float, float, str]]] = {}
    estimate = refit.estimate
    for candidate, block in zip(refit.wanted, refit.fit.prior.blocks('effect'), strict=True):
        own = by_effect.setdefault(candidate.name, {})
        for parameter, place in zip(candidate.effect.parameters, block, strict=True):
            numbers = (estimate.values[place], estimate.low[place], estimate.high[place])
            value, low, high = map(float, numbers)
            own[parameter.name] = (value, low, high, parameter.unit)
    return by_effect
