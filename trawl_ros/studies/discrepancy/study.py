"""The blind tests: which trials are made, diagnosed and scored, and in what order."""

import json
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from dataclasses import asdict, dataclass
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from trawl_ros.errors import TrawlError
from trawl_ros.files import empty_folder, write_json
from trawl_ros.studies.discrepancy.diagnosing import Case, diagnose_case
from trawl_ros.studies.discrepancy.inside import INSIDE
from trawl_ros.studies.discrepancy.making import Spec, make
from trawl_ros.studies.discrepancy.outside import OUTSIDE
from trawl_ros.studies.discrepancy.windows_file import write_windows
from trawl_ros.studies.identification.plant import Cut

SEED = 32
"""Of the study as it is reported; rules were chosen by looking at trials of 1 and 31."""

FINER = Cut(around=12, lines=2, unjoined=True)
"""Plant and model."""

PLANTS = 8
STRENGTHS = (1.5, 3.0, 6.0)
OUTSIDE_STRENGTHS = (6.0, 10.0)
PAIR_STRENGTH = 3.0

PAIRS = (
    ('current_shear', 'tension_cell'),
    ('catch_build_up', 'counter_offset'),
    ('warp_asymmetry', 'spread_sensor'),
    ('speed_log', 'depth_sensor'),
    ('net_drag', 'cross_current'),
    ('counter_scale', 'tension_cell'),
)


@dataclass(frozen=True)
class Plan:
    """How large the study is.

    Attributes
    ----------
    gear
        File or name.
    seed
        Of all trials.
    clean
        Trials without any effect.
    inside
        Trials of each effect of the catalogue and strength, to both sides in turn.
    outside
        Trials of each effect that is not in it and strength, likewise.
    pairs
        Trials of each of `PAIRS`.
    around
        Meshes around the mouth of the model's net.
    """

    gear: str = 'kaifuha'
    seed: int = SEED
    clean: int = 60
    inside: int = 1
    outside: int = 1
    pairs: int = 1
    around: int = FINER.around

    @property
    def cut(self) -> Cut:
        """How fine model and plant are."""
        return Cut(**{**asdict(FINER), 'around': self.around})

    def specs(self) -> Iterator[Spec]:
        """All trials."""
        chance = np.random.default_rng([self.seed, *b'plan'])

        def spec(
            series: str, effects: tuple[str, ...], strength: float, signs: tuple[float, ...]
        ) -> Spec:
            number = next(numbers)
            return Spec(series, number, effects, strength, signs, int(chance.integers(PLANTS)))

        numbers = iter(range(1_000_000))
        for _ in range(self.clean):
            yield spec('clean', (), 0.0, ())
        for kind, group, strengths, many in (
            ('inside', INSIDE, STRENGTHS, self.inside),
            ('outside', OUTSIDE, OUTSIDE_STRENGTHS, self.outside),
        ):
            for name, strength in product(group, strengths):
                signs = group[name](np.random.default_rng(0)).signs
                first = int(chance.integers(len(signs)))
                for turn in range(many):
                    # To both sides in turn, whichever comes first.
                    yield spec(kind, (name,), strength, (signs[(first + turn) % len(signs)],))
        for names in PAIRS:
            for _ in range(self.pairs):
                signs = tuple(
                    float(chance.choice(INSIDE[name](np.random.default_rng(0)).signs))
                    for name in names
                )
                yield spec('pair', names, PAIR_STRENGTH, signs)


@dataclass(frozen=True)
class Making:
    """A trial to be made, and where its parts go."""

    spec: Spec
    gear: str
    cut: Cut
    seed: int
    windows: Path
    key: Path


def make_case(making: Making) -> bool:
    """Make a trial and write what may be seen of it and its key apart from each other; whether it
    is testable.
    """
    key, windows = make(making.spec, making.gear, making.cut, making.seed)
    if windows is not None:
        write_windows(making.windows, windows)
    write_json(making.key, key.record())
    return key.testable


@dataclass(frozen=True)
class Scored:
    """A trial's key, and its diagnosis, None where the trial is not testable."""

    key: dict[str, Any]
    diagnosis: dict[str, Any] | None


Steps = Callable[[str, int], AbstractContextManager[Callable[[], None]]]


def run_blind(
    plan: Plan,
    folder: Path,
    steps: Steps,
    *,
    scheduler: str | None = None,
    workers: int | None = None,
    force: bool = False,
) -> tuple[Scored, ...]:
    """Make and diagnose the trials that are not there yet, and set them beside their keys.

    Parameters
    ----------
    plan
        How many.
    folder
        Takes ``trials``, ``keys`` and ``diagnoses``.
    steps
        Shows progress.
    scheduler, workers
        As in `trawl_ros.parallel.run_tasks`; a cluster must see the folder under the same path.
    force
        Whether to begin anew.

    Raises
    ------
    TrawlError
        If trials of another plan are kept there, or one fails.
    """
    # Dask takes a second to import, for which other commands need not wait.
    from trawl_ros.parallel import run_tasks

    folders = _prepared(plan, folder.resolve(), force=force)
    trials, keys, diagnoses = folders
    specs = list(plan.specs())
    names = dict(zip(specs, _names(plan, len(specs)), strict=True))
    making = {
        f'{spec.series} {spec.number}': Making(
            spec, plan.gear, plan.cut, plan.seed,
            trials / f'{name}.json', keys / f'{name}.json',
        )
        for spec, name in names.items()
        if not (keys / f'{name}.json').is_file()
    }  # fmt: skip
    with steps('making trials', len(making)) as done:
        for _ in run_tasks(make_case, making, scheduler=scheduler, workers=workers):
            done()
    # Other processes than those that made them, which know no more than a name by chance.
    cases = {
        name: Case(trials / f'{name}.json', diagnoses / f'{name}.json', plan.gear, plan.cut)
        for name in sorted(names.values())
        if (trials / f'{name}.json').is_file() and not (diagnoses / f'{name}.json').is_file()
    }
    with steps('diagnosing', len(cases)) as done:
        for _ in run_tasks(diagnose_case, cases, scheduler=scheduler, workers=workers):
            done()
    return tuple(
        Scored(_json(keys / f'{name}.json'), _json(diagnoses / f'{name}.json'))
        for name in names.values()
    )


def _json(path: Path) -> Any:
    return json.loads(path.read_text(encoding='utf-8')) if path.is_file() else None


def _names(plan: Plan, number: int) -> list[str]:
    chance = np.random.default_rng([plan.seed, *b'names'])
    return [chance.bytes(6).hex() for _ in range(number)]


def _prepared(plan: Plan, folder: Path, *, force: bool) -> tuple[Path, Path, Path]:
    asked = json.loads(json.dumps(asdict(plan)))
    about = folder / 'plan.json'
    folders = (folder / 'trials', folder / 'keys', folder / 'diagnoses')
    if about.is_file() and not force:
        known = json.loads(about.read_text(encoding='utf-8'))
        if known != asked:
            different = ', '.join(key for key in asked if asked[key] != known.get(key))
            raise TrawlError(
                f'{about}: has trials with another {different}, expected the same, another '
                'folder, or --force'
            )
    else:
        empty_folder(folder, force=force)
        for part in folders:
            part.mkdir(parents=True, exist_ok=True)
            for old in part.glob('*.json'):
                old.unlink()
        about.write_text(json.dumps(asked) + '\n', encoding='utf-8')
    return folders
