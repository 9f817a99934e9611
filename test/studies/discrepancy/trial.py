"""One blind trial: made, diagnosed, and kept with all that its score takes."""

from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

import trawl_ros.diagnosis
import trawl_ros.effects
from studies.kept import TrialTask
from trawl_ros.core.resources import share_path
from trawl_ros.diagnosis.inference.posterior import Posterior
from trawl_ros.diagnosis.procedure import diagnose_windows
from trawl_ros.lab.missing_effect.answering import answer_of, timed
from trawl_ros.lab.missing_effect.calibration import Case
from trawl_ros.lab.missing_effect.records import AnswerRecord, TruthRecord
from trawl_ros.lab.missing_effect.trials_folder import truth_of
from trawl_ros.lab.trials.making import gear_aboard, make
from trawl_ros.lab.trials.plant import FINER_MESH
from trawl_ros.lab.trials.tows import PLANS
from trawl_ros.lab.trials.trial import Spec

KEPT_EXPLANATIONS = 40
"""Number of explanations that are kept, the likeliest first."""

NOT_RULES = ('onset', 'report')
"""Folders of the diagnosis that decide on no verdict."""


@cache
def rules_hash() -> str:
    """Return the SHA-256 of all that decides on a verdict: code, effects, library."""
    digest = sha256()
    for folder, pattern in (
        (Path(trawl_ros.diagnosis.__path__[0]), '*.py'),
        (Path(trawl_ros.effects.__path__[0]), '*.py'),
        (share_path('config', 'hypotheses'), '*.yaml'),
    ):
        for file in sorted(folder.rglob(pattern)):
            name = file.relative_to(folder)
            if name.parts[0] not in NOT_RULES:
                digest.update(f'{folder.name}/{name.as_posix()}\n'.encode())
                digest.update(file.read_bytes())
    return digest.hexdigest()


@dataclass(frozen=True)
class BlindTask(TrialTask):
    """Task of a blind trial."""

    spec: Spec


@dataclass(frozen=True)
class BlindTrial:
    """Blind trial with its truth and the answer of the diagnosis.

    Attributes
    ----------
    series, number
        Series of the trial, and its number.
    rules
        SHA-256 of all that decided.
    why_not
        Reason why it cannot be made; empty if it can.
    truth, answer
        `TruthRecord` and `AnswerRecord` as plain values; None if it cannot be made.
    explanations
        Paths of nodes, whether something unknown is there, log prior odds and log Bayes factor of
        the likeliest explanations.
    """

    series: str
    number: int
    rules: str
    why_not: str = ''
    truth: dict[str, Any] | None = None
    answer: dict[str, Any] | None = None
    explanations: tuple[tuple[Any, ...], ...] = ()

    @property
    def case(self) -> Case:
        """Truth and answer as records."""
        # JSON has lists where records have tuples.
        return (
            TruthRecord.model_validate(self.truth, strict=False),
            AnswerRecord.model_validate(self.answer, strict=False),
        )


def run_blind(task: BlindTask) -> BlindTrial:
    """Make a trial and diagnose it."""
    spec = task.spec
    key, windows = make(spec, task.gear, FINER_MESH, task.seed)
    if windows is None:
        return BlindTrial(spec.series, spec.number, rules_hash(), key.why_not)
    plan = PLANS[spec.plan]
    gear = gear_aboard(task.gear, FINER_MESH, task.seed, spec.plant, spec.plan)
    tows = [f'tow {place + 1}' for place in range(len(plan.tows))]
    baseline = frozenset(range(plan.baseline))
    found, seconds = timed(lambda: diagnose_windows(gear, windows, tows, baseline))
    answer = answer_of(found).model_copy(update={'seconds': seconds})
    return BlindTrial(
        spec.series,
        spec.number,
        rules_hash(),
        truth=truth_of(key).model_dump(mode='json'),
        answer=answer.model_dump(mode='json'),
        explanations=() if found.posterior is None else kept_explanations(found.posterior),
    )


def kept_explanations(posterior: Posterior) -> tuple[tuple[Any, ...], ...]:
    """Return what a temperature changes of the likeliest explanations."""
    return tuple(
        (
            tuple(suspect.entry.node.path for suspect in own.suspects),
            own.unknown is not None,
            own.log_odds,
            own.log_factor,
        )
        for own in posterior.explanations[:KEPT_EXPLANATIONS]
    )
