"""Stages of the blind tests: made, diagnosed, towed on, diagnosed, fitted without errors."""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from hashlib import sha256
from pathlib import Path
from shutil import rmtree
from typing import Any, TypeVar

import numpy as np
import yaml

import trawl_ros.diagnosis
import trawl_ros.effects
from studies.discrepancy.costs import COSTS, MAKING, Timed, keep_cost
from studies.discrepancy.plan import BlindStudyPlan
from studies.harness import Work
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import empty_folder, made_folder, write_json, write_text
from trawl_ros.core.parallel import run_tasks
from trawl_ros.core.progress import step_counter
from trawl_ros.core.resources import share_path
from trawl_ros.diagnosis.diagnosis import values_of
from trawl_ros.diagnosis.holdout import split
from trawl_ros.diagnosis.refit import fit_boards, refitted
from trawl_ros.diagnosis.score_test import score_test
from trawl_ros.effects.effect_set import effects_of
from trawl_ros.effects.registry import catalogue
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.trials.diagnosing import (
    DiagnosisTask,
    diagnose_case,
    read_windows,
    write_windows,
)
from trawl_ros.lab.trials.making import (
    gear_aboard,
    likelihood_of,
    make,
    make_bags,
    proposed,
    tow_on,
)
from trawl_ros.lab.trials.tows import PLANS
from trawl_ros.lab.trials.trial import Scored, Spec
from trawl_ros.lab.trials.verdicts import Classes, classes, named_right
from trawl_ros.model.gear_model import build_model
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.solver.predict import Predictor

DECIDES_NOTHING = ('onset', 'report')
"""Folders that do not count: the watch over a tow in motion, and the texts of reports."""


def rules_hash() -> str:
    """SHA-256 of the files by their names and contents, in the order of the names."""
    digest = sha256()
    for folder, pattern in (
        (Path(trawl_ros.diagnosis.__path__[0]), '*.py'),
        (Path(trawl_ros.effects.__path__[0]), '*.py'),
        (share_path('config', 'mimics'), '*.yaml'),
    ):
        for file in sorted(folder.rglob(pattern)):
            name = file.relative_to(folder)
            if name.parts[0] not in DECIDES_NOTHING:
                digest.update(f'{folder.name}/{name.as_posix()}\n'.encode())
                digest.update(file.read_bytes())
    return digest.hexdigest()


def fit_quietly(
    gear: GearRecord, windows: Sequence[SteadyWindow], name: str, baseline: frozenset[int]
) -> dict[str, Any] | None:
    """Fit boards and one effect of the catalogue to the windows that decide.

    Returns
    -------
    dict or None
        Values by the effect's ``parameters`` and by ``coefficients``; None where nothing fits.
    """
    predictor = Predictor(build_model(gear), effects_of(gear), without=baseline)
    base = fit_boards(predictor, board_prior(gear), split(windows, baseline).deciding)
    if base is None:
        return None
    seen = score_test(predictor, base.fit, {name: catalogue()[name]})
    best = refitted(predictor, base, seen, (max(seen.wanted, key=seen.penalised),))
    if best is None:
        return None
    coefficients = map(float, best.estimate.values[: len(COEFFICIENTS)])
    return {
        'parameters': {key: value for key, (value, *_) in values_of(best)[name].items()},
        'coefficients': dict(zip(COEFFICIENTS, coefficients, strict=True)),
    }


Task = TypeVar('Task')

FOLDERS = ('gears', 'trials', 'keys', 'quiet', 'diagnoses', 'fits')
CLASSES = 'classes.json'
RULES = 'rules.json'
"""Hash of what decides on a verdict, of when the folder was begun."""

ON = '_on'
"""Ends the names of trials that were towed on."""

QUIET_STRENGTH = 3.0


@dataclass(frozen=True)
class Blind:
    """Blind trial: its files, and all that making it takes."""

    spec: Spec
    name: str
    plan: BlindStudyPlan
    folder: Path

    def at(self, part: str) -> Path:
        """Return the trial's file in a folder."""
        return self.folder / part / f'{self.name}.json'

    @property
    def seen(self) -> Path:
        """Visible data for the diagnosis: a file of windows, or a folder of bags."""
        windows = self.at('trials')
        return windows if self.spec.form == 'windows' else windows.with_suffix('')

    @property
    def baseline(self) -> int:
        """Number of its baseline tows."""
        return PLANS[self.spec.plan].baseline

    @property
    def scored(self) -> Scored:
        """Its key, and the diagnosis so far."""
        return Scored(*(_json(self.at(part)) for part in ('keys', 'diagnoses', 'fits')))

    @property
    def case(self) -> DiagnosisTask:
        """Case for the diagnosis, under a random name alone."""
        return DiagnosisTask(self.seen, self.at('diagnoses'), self.gear_file, self.baseline)

    @property
    def gear_file(self) -> Path:
        """Gear file as it is known aboard."""
        return self.at('gears').with_suffix('.yaml')

    def write_gear(self) -> None:
        """Write the gear file."""
        plan = self.plan
        known = gear_aboard(plan.gear, plan.mesh, plan.seed, self.spec.plant)
        write_text(self.gear_file, yaml.safe_dump(known.model_dump(mode='json'), sort_keys=False))


def make_case(trial: Blind) -> None:
    """Make a trial, and write its visible data and its key apart from each other."""
    plan = trial.plan
    trial.write_gear()
    if trial.spec.form != 'windows':
        # The rest of an interrupted run is not whole.
        rmtree(trial.seen, ignore_errors=True)
        key = make_bags(trial.spec, plan.gear, plan.mesh, plan.seed, trial.seen)
    else:
        key, made = make(trial.spec, plan.gear, plan.mesh, plan.seed)
        if made is not None:
            write_windows(trial.seen, made.windows)
            write_windows(trial.at('quiet'), made.quiet)
    write_json(trial.at('keys'), key.record())


def follow_case(trial: Blind) -> None:
    """Tow on as the diagnosis of a trial proposes."""
    tow, plan = proposed(_json(trial.at('diagnoses'))), trial.plan
    assert tow is not None
    on = _followed(trial)
    windows = read_windows(trial.seen)
    key, more = tow_on(trial.spec, plan.gear, plan.mesh, plan.seed, windows, tow)
    on.write_gear()
    if more is not None:
        write_windows(on.seen, more)
    write_json(on.at('keys'), key.record())


def quiet_case(trial: Blind) -> None:
    """Fit the rightly named effect to readings without errors."""
    found = fit_quietly(
        load_gear(trial.gear_file),
        read_windows(trial.at('quiet')),
        trial.spec.effects[0],
        frozenset(range(trial.baseline)),
    )
    write_json(trial.at('fits'), found)


def run_blind(plan: BlindStudyPlan, work: Work) -> tuple[Scored, ...]:
    """Make and diagnose the trials that are missing, and compare them with their keys.

    The folder takes `FOLDERS`, the plan and the classes; a cluster must see it under the same path.

    Raises
    ------
    TrawlError
        If trials of another plan are kept there, or one fails.
    """
    folder = work.folder.resolve()

    def stage(title: str, act: Callable[[Task], Any], tasks: Mapping[str, Task]) -> None:
        done = step_counter(title, len(tasks), work.on_progress)
        timed = run_tasks(Timed(act), tasks, scheduler=work.scheduler, workers=work.workers)
        for name, seconds in timed:
            keep_cost(folder, title, name, seconds)
            done()

    _prepare(plan, folder, force=work.force)
    if not (folder / CLASSES).is_file():
        # Before any trial is made: what is no name of its own is not chosen afterwards.
        likely = likelihood_of(plan.gear, plan.mesh, plan.seed, 0, 'full')
        write_json(folder / CLASSES, classes(likely))
    specs = plan.specs()
    trials = [
        Blind(spec, name, plan, folder)
        for spec, name in zip(specs, _names(plan, len(specs)), strict=True)
    ]
    # Those that take longest first, lest one is left over at the end.
    trials = sorted(trials, key=lambda one: one.spec.form)
    stage(MAKING, make_case, {
        f'{one.spec.series} {one.spec.number}': one
        for one in trials if not one.at('keys').is_file()
    })  # fmt: skip
    stage('diagnosing', diagnose_case, _cases(trials))
    doubtful = [one for one in trials if _may_be_followed(one.scored)]
    followed = [_followed(one) for one in doubtful]
    stage('towing on', follow_case, {
        one.name: one
        for one, on in zip(doubtful, followed, strict=True) if not on.at('keys').is_file()
    })  # fmt: skip
    stage('diagnosing what was towed on', diagnose_case, _cases(followed))
    kinds = read_classes(folder)
    stage('fitting without errors', quiet_case, {
        one.name: one
        for one in trials if _is_fitted(one, kinds) and not one.at('fits').is_file()
    })  # fmt: skip
    by_number = sorted(trials, key=lambda one: one.spec.number)
    return tuple(one.scored for one in (*by_number, *followed))


def read_classes(folder: Path) -> Classes:
    """Read the classes that were found before any trial was made."""
    return {name: tuple(names) for name, names in _json(folder / CLASSES).items()}


def _cases(trials: list[Blind]) -> dict[str, DiagnosisTask]:
    return {
        one.name: one.case
        for one in sorted(trials, key=lambda one: (one.spec.form, one.name))
        if one.seen.exists() and one.at('keys').is_file() and not one.at('diagnoses').is_file()
    }


def _may_be_followed(trial: Scored) -> bool:
    """True if a tow is proposed that could decide between the rivals in a poor trial."""
    return (
        trial.key['spec']['series'] == 'poor'
        and trial.diagnosis is not None
        and trial.diagnosis['verdict'] in ('NAMED', 'AMBIGUOUS')
        and proposed(trial.diagnosis) is not None
    )


def _followed(trial: Blind) -> Blind:
    return Blind(trial.spec, f'{trial.name}{ON}', trial.plan, trial.folder)


def _is_fitted(trial: Blind, kinds: Classes) -> bool:
    scored = trial.scored
    return (
        trial.spec.series == 'inside'
        and trial.spec.form == 'windows'
        and trial.spec.strength == QUIET_STRENGTH
        and scored.diagnosis is not None
        and named_right(scored, kinds)
    )


def _json(path: Path) -> Any:
    return json.loads(path.read_text(encoding='utf-8')) if path.is_file() else None


def _names(plan: BlindStudyPlan, number: int) -> list[str]:
    rng = np.random.default_rng([plan.seed, *b'names'])
    return [rng.bytes(6).hex() for _ in range(number)]


def _prepare(plan: BlindStudyPlan, folder: Path, *, force: bool) -> None:
    asked = json.loads(json.dumps(asdict(plan)))
    about = folder / 'plan.json'
    if about.is_file() and not force:
        known = _json(about)
        if known != asked:
            different = ', '.join(key for key in asked if asked[key] != known.get(key))
            raise TrawlError(
                f'{about}: has trials with another {different}, expected the same, another '
                'folder, or --force'
            )
        _same_rules(folder)
        return
    empty_folder(folder, force=force)
    for name in (CLASSES, COSTS, RULES):
        (folder / name).unlink(missing_ok=True)
    for part in FOLDERS:
        if about.is_file():
            rmtree(folder / part, ignore_errors=True)
        made_folder(folder / part)
    write_json(folder / RULES, {'diagnosis_sha256': rules_hash()})
    write_json(about, asked)


def _same_rules(folder: Path) -> None:
    """Refuse to go on by other rules than those by which the first trials were diagnosed."""
    known = _json(folder / RULES)
    if known is not None and known['diagnosis_sha256'] != rules_hash():
        raise TrawlError(
            f'{folder / RULES}: the rules of the diagnosis have changed since these trials were '
            'begun, expected the same, another folder, or --force'
        )
