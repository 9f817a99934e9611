"""Knowledge of the boards when a watched tow begins: drawn around the truth, or by a tow before."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import yaml

from studies.onset.plant import COURSE, towed_samples
from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import write_text
from trawl_ros.diagnosis.onset.knowledge import STATED, Knowledge, of_gear_file
from trawl_ros.effects.effect_set import NO_EFFECTS
from trawl_ros.estimation.bag_motion import fit_tows, moving_parts
from trawl_ros.estimation.from_gear import board_prior, identification_for
from trawl_ros.estimation.motion.series import tow_readings
from trawl_ros.estimation.windows.noise_density import noise_densities
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.water import build_water
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.scenario.scenario import Scenario, load_scenario

KNOWN = 0.2
"""Std of each board's coefficient where it is drawn, in that of the gear file's prior: about what
all of a tow before tells of the twelve (0.11 to 0.19 in three trials, geometric mean; its steady
windows 0.5 to 0.7). Errors that are drawn know nothing of one another; those of a tow cancel."""

STATES, STATE_MIN = 6, 9.0
"""States of the course that are towed before, at most, and minutes of each: as in the demo."""

BY_TOW, BY_WINDOWS, BY_FILE = 'all of a tow', 'its steady windows', 'the gear file'
"""Sources of knowledge: windows where a fit of all of the tow finds no rest, and the gear file
where there are none."""


def drawn_knowledge(gear: GearRecord, truth: FloatArray, rng: np.random.Generator) -> Knowledge:
    """Boards as they are known: the truth, wrong by as much as is stated, within their bounds.

    Parameters
    ----------
    gear
        Gear whose prior says how large `KNOWN` is.
    truth
        Coefficients (12,) of the plant.
    rng
        Generator of random numbers.
    """
    prior = board_prior(gear)
    std = KNOWN * prior.std
    values = truth + std * rng.standard_normal(len(std))
    return Knowledge(np.clip(values, prior.low, prior.high), np.diag(std**2))


def knowledge_by_tow(
    folder: Path, scenario: Scenario, believed: GearRecord, rng: np.random.Generator
) -> tuple[Knowledge, str]:
    """Boards as `trawl identify` finds them in a tow before, through the same states.

    Parameters
    ----------
    folder
        Folder of the course, `random_course`.
    scenario
        The course, of the plant that is towed.
    believed
        Gear of the model.
    rng
        Generator of random numbers.

    Returns
    -------
    Knowledge
        As the watch takes it from an ``identification.json``.
    str
        Its source.
    """
    course = yaml.safe_load((folder / COURSE).read_text(encoding='utf-8'))
    course['seed'] = int(rng.integers(2**31))
    course['steps'] = [step | {'minutes': STATE_MIN} for step in course['steps'][:STATES]]
    path = folder / 'before.yaml'
    write_text(path, yaml.safe_dump(course))
    before = replace(load_scenario(path), plant=scenario.plant)
    samples = [one for some, _ in towed_samples(before, NO_EFFECTS) for one in some]
    identification = identification_for(believed)
    for sample in samples:
        identification.feed(sample)
    identification.finish()
    estimate = identification.estimate
    by_windows = None if estimate is None else identification
    densities = noise_densities(identification.estimator.windows) if estimate else {}
    try:
        read = tow_readings(samples, build_water(believed).depth, path.stem)
        parts = list(moving_parts(read, path.stem))
        learned = fit_tows(believed, by_windows, parts, [0] * len(parts), ())
        if learned.fit.converged:
            sizes = learned.fit.sizes.no_less_than(STATED)
            return Knowledge(learned.fit.values, learned.fit.covariance, densities, sizes), BY_TOW
    except TrawlError:
        # The study counts how often; `trawl identify` falls back likewise, and says so.
        pass
    if estimate is None:
        return of_gear_file(believed), BY_FILE
    own = slice(0, len(COEFFICIENTS))
    covariance = np.array(estimate.covariance)[own, own]
    return Knowledge(estimate.values[own], covariance, densities), BY_WINDOWS
