# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Writer and reader of a folder of blind trials; the key is a file next to the folder.

The folder holds ``trials.json`` and a folder per trial. Methods read them and write a file of
answers. The key holds the hidden causes. ``trials.json`` has the key's SHA-256, so that a later
change of the key is noticed.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from difflib import get_close_matches
from hashlib import sha256
from pathlib import Path
from shutil import rmtree

from pydantic import TypeAdapter

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import empty_folder, made_folder, write_json, write_text, written_folder
from trawl_ros.core.foreign import load_json, reading
from trawl_ros.core.progress import OnProgress, ignore, step_counter
from trawl_ros.core.schema import RecordT, validated
from trawl_ros.diagnosis.inference.posterior import above as above_path
from trawl_ros.diagnosis.library.entries import library
from trawl_ros.diagnosis.repair import gear_text
from trawl_ros.estimation.bag_windows import BagTask, read_tow
from trawl_ros.estimation.tows import numbered
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.missing_effect.plan import drawn_spec
from trawl_ros.lab.missing_effect.records import (
    NOTHING,
    SOMETHING_ELSE,
    AnswersRecord,
    CauseRecord,
    HypothesisRecord,
    KeyRecord,
    TrialRecord,
    TrialsRecord,
    TruthRecord,
)
from trawl_ros.lab.trials.answers import right_leaves, right_nodes, right_sizes
from trawl_ros.lab.trials.making import gear_aboard, make, make_bags
from trawl_ros.lab.trials.plant import FINER_MESH
from trawl_ros.lab.trials.tows import PLANS
from trawl_ros.lab.trials.trial import Form, Key, Spec
from trawl_ros.records.topics import NAMESPACE

TRIALS_FILE, WINDOWS_FILE, GEAR_FILE, BAGS_FOLDER = (
    'trials.json', 'windows.json', 'gear.yaml', 'bags',
)  # fmt: skip
"""Names in the folder of the trials, and in the folder of each trial (the last three)."""


@dataclass(frozen=True)
class TrialInput:
    """Data of a trial, all that a method gets.

    Attributes
    ----------
    gear
        Gear as its file describes it aboard, without the hidden causes.
    windows
        Steady windows of all tows.
    tows
        Names of the tows, in their order.
    baseline
        Numbers, from 0, of the tows with the gear in order.
    """

    gear: GearRecord
    windows: tuple[SteadyWindow, ...]
    tows: tuple[str, ...]
    baseline: frozenset[int]


def key_file(folder: Path) -> Path:
    """Return the path of the key of a folder of trials, next to that folder."""
    return folder.with_name(f'{folder.name}_key.json')


def make_trials(
    folder: Path,
    *,
    seed: int,
    trials: int,
    gear: str = 'kaifuha',
    form: Form = 'windows',
    on_progress: OnProgress = ignore,
) -> KeyRecord:
    """Make blind trials, or continue an interrupted call for the same folder.

    Parameters
    ----------
    folder
        Folder of the trials; the key is written next to it.
    seed, gear
        Seed of all random draws; gear file, or name of a built-in one.
    trials
        Number of trials in the finished folder, those of earlier calls included.
    form
        Form of the data: steady windows or bags.
    on_progress
        Called after each trial.

    Returns
    -------
    KeyRecord
        Key of all trials. Drawn trials that could not be made are in it with the reason.

    Raises
    ------
    TrawlError
        If the folder holds trials of another seed, gear or form, or cannot be written.
    """
    load_gear(gear)  # a wrong name must not leave a folder behind
    key = KeyRecord(seed=seed, gear=gear, form=form, trials={}, not_possible={})
    if key_file(folder).exists():
        # Continue only a folder that was begun with the same arguments.
        wanted, key = key, _read(KeyRecord, key_file(folder))
        for name in ('seed', 'gear', 'form'):
            if getattr(key, name) != getattr(wanted, name):
                raise TrawlError(
                    f'{key_file(folder)}: found trials of {name} {getattr(key, name)}, expected '
                    f'{name} {getattr(wanted, name)}, or another folder'
                )
    else:
        empty_folder(folder, force=False)
    made_folder(folder)
    done = step_counter('trials', max(0, trials - len(key.trials)), on_progress)
    while len(key.trials) < trials:
        number = len(key.trials) + len(key.not_possible)
        spec = drawn_spec(seed, number, form)
        made = _make_one(folder, spec, key)
        if made.testable:
            key.trials[trial_name(number)] = truth_of(made)
            done()
        else:
            key.not_possible[trial_name(number)] = made.why_not
        write_key(folder, key)
    return key


def trial_name(number: int) -> str:
    """Return the name of the trial with a number, which is also that of its folder."""
    return f'trial_{number:03}'


def _make_one(folder: Path, spec: Spec, key: KeyRecord) -> Key:
    """Make the folder of one trial; a trial that cannot be tested leaves none."""
    path = folder / trial_name(spec.number)
    if path.exists():
        # An earlier call was interrupted before it wrote the key of this trial.
        rmtree(path)
    with written_folder(path, TrawlError) as draft:
        draft.mkdir()
        if spec.form == 'windows':
            made, windows = make(spec, key.gear, FINER_MESH, key.seed)
            write_windows(draft / WINDOWS_FILE, windows or ())
        else:
            made = make_bags(spec, key.gear, FINER_MESH, key.seed, draft / BAGS_FOLDER)
        gear = gear_aboard(key.gear, FINER_MESH, key.seed, spec.plant, spec.plan)
        write_text(draft / GEAR_FILE, gear_text(gear))
    if not made.testable:
        rmtree(path)
    return made


def truth_of(key: Key) -> TruthRecord:
    """Return the truth of a trial: hidden causes, right answers, and board coefficients (12,)."""
    return TruthRecord(
        series=key.spec.series,
        strength=key.spec.strength,
        causes=tuple(
            CauseRecord(
                name=name,
                size=float(size),
                unit=unit,
                leaves=right_leaves(name),
                nodes=right_nodes(name),
                sizes=dict(right_sizes(name, float(size))),
            )
            for name, size, unit in zip(key.spec.effects, key.sizes, key.units, strict=True)
        ),
        coefficients=key.coefficients,
        floor=dict(key.floor),
    )


def write_key(folder: Path, key: KeyRecord) -> None:
    """Write the key next to the folder, and ``trials.json``, which a method may see, into it."""
    write_json(key_file(folder), key.model_dump(mode='json'), indent=1)
    # All trials have the same plan of tows.
    plan = PLANS[drawn_spec(key.seed, 0).plan]
    names = tuple(f'tow_{number:02}' for number in range(1, len(plan.tows) + 1))
    record = TrialsRecord(
        format=1,
        form=key.form,
        key_sha256=sha256(key_file(folder).read_bytes()).hexdigest(),
        trials=tuple(
            TrialRecord(name=name, tows=names, baseline=plan.baseline) for name in key.trials
        ),
        hypotheses=hypotheses(load_gear(key.gear)),
    )
    write_json(folder / TRIALS_FILE, record.model_dump(mode='json'), indent=1)


def hypotheses(gear: GearRecord) -> tuple[HypothesisRecord, ...]:
    """Return all hypotheses of the library for a gear, with the units of their parameters."""
    return tuple(
        HypothesisRecord(
            path=entry.path,
            sentence=entry.effect.sentence,
            check=entry.check,
            parameters={
                entry.effect.parameters[place].name: entry.effect.parameters[place].unit
                for place in entry.places
            },
        )
        for entry in library(gear)
    )


def read_trials(folder: Path) -> TrialsRecord:
    """Read ``trials.json``, which a method may see.

    Raises
    ------
    TrawlError
        If it is missing or damaged.
    """
    if not (folder / TRIALS_FILE).exists():
        raise TrawlError(
            f'{folder}: found no {TRIALS_FILE}, expected a folder of '
            f'`trawl missing-effect make {folder}`'
        )
    return _read(TrialsRecord, folder / TRIALS_FILE)


def read_input(folder: Path, trial: TrialRecord, form: Form) -> TrialInput:
    """Read the data of a trial.

    Raises
    ------
    TrawlError
        If a file is missing or damaged.
    """
    path = folder / trial.name
    gear = load_gear(path / GEAR_FILE)
    windows = (
        read_windows(path / WINDOWS_FILE)
        if form == 'windows'
        else read_bags([path / BAGS_FOLDER / tow for tow in trial.tows], gear)
    )
    return TrialInput(gear, windows, trial.tows, frozenset(range(trial.baseline)))


def write_windows(path: Path, windows: Sequence[SteadyWindow]) -> None:
    """Write steady windows as JSON."""
    write_json(path, [asdict(window) for window in windows])


def read_windows(path: Path) -> tuple[SteadyWindow, ...]:
    """Read steady windows from a JSON file."""
    records = load_json(path, TrawlError)
    with reading(path, TrawlError):
        return TypeAdapter(tuple[SteadyWindow, ...]).validate_python(records)


def read_bags(bags: Sequence[Path], gear: GearRecord) -> tuple[SteadyWindow, ...]:
    """Find the steady windows of bags, one bag for each tow, in the order of the tows."""
    windows, _ = numbered([read_tow(BagTask(bag, gear, NAMESPACE)) for bag in bags])
    return tuple(windows)


def read_key(folder: Path, path: Path | None = None) -> KeyRecord:
    """Read and check the key of a folder of trials.

    Parameters
    ----------
    folder
        Folder of the trials.
    path
        File of the key; by default the one next to the folder.

    Raises
    ------
    TrawlError
        If the key is missing, or its SHA-256 is not that in ``trials.json``.
    """
    path = path or key_file(folder)
    key = _read(KeyRecord, path)
    found, expected = sha256(path.read_bytes()).hexdigest(), read_trials(folder).key_sha256
    if found != expected:
        raise TrawlError(
            f'{path}: found SHA-256 {found[:12]}…, expected {expected[:12]}… as in '
            f'{folder / TRIALS_FILE}; give the key that was made with these trials'
        )
    return key


def read_answers(path: Path, trials: TrialsRecord, *, complete: bool = True) -> AnswersRecord:
    """Read and check a file of answers.

    Parameters
    ----------
    path
        File of the answers.
    trials
        Content of ``trials.json``.
    complete
        True if an answer to each trial is required.

    Raises
    ------
    TrawlError
        If an answer is missing, or belongs to no trial, or has a path that is no hypothesis.
    """
    answers = _read(AnswersRecord, path)
    missing = [name for name in trials.names if name not in answers.trials]
    if complete and missing:
        raise TrawlError(
            f'{path}: trials: found no answer to {missing[0]} ({len(missing)} of '
            f'{len(trials.names)} are missing), expected an answer to each trial'
        )
    leaves = {hypothesis.path for hypothesis in trials.hypotheses}
    # An answer may also name a node above a leaf.
    paths = leaves | {above for leaf in leaves for above in above_path(leaf)}
    for name, answer in answers.trials.items():
        if name not in trials.names:
            raise TrawlError(
                f'{path}: trials: found {name}, expected names of {TRIALS_FILE}: '
                f'{trials.names[0]} to {trials.names[-1]}'
            )
        for named in sorted(answer.paths):
            if named not in paths:
                near = get_close_matches(named, paths, 1)
                raise TrawlError(
                    f'{path}: trials.{name}: found {named}, expected {NOTHING}, {SOMETHING_ELSE} '
                    f'or a path of `hypotheses` in {TRIALS_FILE} or a part of one'
                    + (f'; did you mean {near[0]}?' if near else '')
                )
    return answers


def _read(kind: type[RecordT], path: Path) -> RecordT:
    return validated(kind, load_json(path, TrawlError), path, TrawlError)
