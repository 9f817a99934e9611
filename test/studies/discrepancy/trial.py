"""One blind trial: made, diagnosed, and kept with all that its score takes."""

import time
from dataclasses import dataclass, replace
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

import trawl_ros.diagnosis
import trawl_ros.effects
from studies.kept import TrialTask
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.resources import share_path
from trawl_ros.diagnosis.diagnosis import Diagnosis, values_of
from trawl_ros.diagnosis.procedure import diagnose_windows
from trawl_ros.lab.trials.making import gear_aboard, make
from trawl_ros.lab.trials.plant import FINER
from trawl_ros.lab.trials.tows import PLANS
from trawl_ros.lab.trials.trial import Spec
from trawl_ros.records.coefficients import COEFFICIENTS

KEPT_EXPLANATIONS = 40
"""Number of explanations that are kept, the likeliest first."""


DECIDES_NOTHING = ('onset', 'report')
"""Folders that do not count: the watch over a tow in motion, and the texts of reports."""


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
            if name.parts[0] not in DECIDES_NOTHING:
                digest.update(f'{folder.name}/{name.as_posix()}\n'.encode())
                digest.update(file.read_bytes())
    return digest.hexdigest()


@dataclass(frozen=True)
class BlindTask(TrialTask):
    """Task of a blind trial."""

    spec: Spec


@dataclass(frozen=True)
class BlindTrial:
    """Blind trial with its diagnosis.

    Attributes
    ----------
    series, number, effects, strength, sizes
        What is hidden.
    why_not
        Why it cannot be tested; empty if it can.
    verdict, named, among
        What was said: paths that are named, leaves that are not excluded.
    nothing, unknown, leaves, nodes
        Probabilities.
    explanations
        Names, paths of nodes, whether something unknown is there, log prior odds and log Bayes
        factor of the likeliest.
    values
        By leaf: value and both ends of its interval of effects with one parameter.
    coefficient_error
        Error of the coefficients with what is named over that without; None if none is named.
    removed
        Share of the excess error on held-out tows that the repair removes.
    worse
        True if a repair worsens a held-out channel by half of what instruments explain, more than
        the plant itself.
    seconds
        Processor time of the diagnosis, s.
    rules
        SHA-256 of all that decided.
    """

    series: str
    number: int
    effects: list[str]
    strength: float
    sizes: list[float]
    why_not: str
    verdict: str = ''
    named: tuple[str, ...] = ()
    among: tuple[str, ...] = ()
    nothing: float = 0.0
    unknown: float = 0.0
    leaves: dict[str, float] | None = None
    nodes: dict[str, float] | None = None
    explanations: tuple[tuple[Any, ...], ...] = ()
    values: dict[str, list[float]] | None = None
    coefficient_error: float | None = None
    removed: float | None = None
    worse: bool | None = None
    seconds: float = 0.0
    rules: str = ''


def run_blind(task: BlindTask) -> BlindTrial:
    """Make a trial and diagnose it."""
    spec = task.spec
    key, data = make(spec, task.gear, FINER, task.seed)
    sizes = [float(size) for size in key.sizes if np.isfinite(size)]
    made = BlindTrial(
        spec.series, spec.number, list(spec.effects), spec.strength, sizes, '', rules=rules_hash()
    )
    if data is None:
        return replace(made, why_not=key.why_not)
    plan = PLANS[spec.plan]
    gear = gear_aboard(task.gear, FINER, task.seed, spec.plant, spec.plan)
    tows = [f'tow {place + 1}' for place in range(len(plan.tows))]
    begun = time.process_time()
    try:
        found = diagnose_windows(gear, data.windows, tows, frozenset(range(plan.baseline)))
    except TrawlError as reason:
        return replace(made, why_not=str(reason))
    seconds = time.process_time() - begun
    posterior = found.posterior
    if posterior is None:
        return replace(made, verdict=found.verdict, seconds=seconds)
    return replace(
        made,
        verdict=found.verdict,
        named=tuple(own.path for own in found.named),
        among=found.among,
        nothing=posterior.nothing,
        unknown=posterior.unknown,
        leaves=dict(posterior.leaves),
        nodes=dict(posterior.nodes),
        explanations=tuple(
            (
                own.names,
                tuple(suspect.entry.node.path for suspect in own.suspects),
                own.unknown is not None,
                own.log_odds,
                own.log_factor,
            )
            for own in posterior.explanations[:KEPT_EXPLANATIONS]
        ),
        values=_values(found),
        coefficient_error=_coefficient_error(found, np.array(key.coefficients)),
        removed=None if found.holdout is None else found.holdout.removed,
        worse=_worse(found, dict(key.floor)),
        seconds=seconds,
    )


def _values(found: Diagnosis) -> dict[str, list[float]] | None:
    if found.best is None or found.best.refit is None:
        return None
    return {
        name: list(next(iter(own.values()))[:3])
        for name, own in values_of(found.best).items()
        if len(own) == 1
    }


def _coefficient_error(found: Diagnosis, truth: np.ndarray) -> float | None:
    best = found.repair
    if best is None or best.refit is None or found.base is None:
        return None
    board = slice(0, len(COEFFICIENTS))
    std = best.refit.estimate.std[board]
    away = [
        float(np.linalg.norm((own.estimate.values[board] - truth) / std))
        for own in (best.refit, found.base)
    ]
    return away[0] / away[1]


def _worse(found: Diagnosis, floor: dict[str, float]) -> bool | None:
    holdout = found.holdout
    if found.repair is None or holdout is None or holdout.after is None:
        return None
    before, after = holdout.before, holdout.after
    return any(
        after.rms[name] > before.expected[name]
        and after.rms[name] - max(before.rms[name], floor[name]) > 0.5 * before.expected[name]
        for name in before.rms
        if name in floor
    )
