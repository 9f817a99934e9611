"""Plants of the trials: a random course, boards drawn from the gear file's prior, and the samples
that instruments take of their tow.
"""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import yaml

from trawl_ros.core.files import write_text
from trawl_ros.effects.effect_set import EffectSet
from trawl_ros.effects.sensor_effects import SensorEffects
from trawl_ros.gear.records import GearRecord
from trawl_ros.instruments.suite import InstrumentSuite
from trawl_ros.model.observables import fallen_boards
from trawl_ros.model.water import build_water
from trawl_ros.records.samples import Sample
from trawl_ros.scenario.run import Trial
from trawl_ros.scenario.scenario import Scenario, load_scenario
from trawl_ros.solver.trimming.drawn_board import draw_board, fastened_as

COURSE = 'scenario.yaml'
"""File of the course within its folder."""

LENGTHS_M, SPEEDS_M_S = (320.0, 480.0), (2.1, 2.45)
LEG_MIN = (3.0, 9.0)


def random_course(
    folder: Path, gear: GearRecord, minutes: float, rng: np.random.Generator
) -> Scenario:
    """Random course, of a plant with the boards of the gear file.

    Parameters
    ----------
    folder
        Takes the gear, as ``gear.yaml``, and the scenario.
    gear
        Of model and plant.
    minutes
        Of the tow.
    rng
        Generator of random numbers.
    """
    write_text(folder / 'gear.yaml', yaml.safe_dump(gear.model_dump(mode='json')))
    length, speed = rng.uniform(*LENGTHS_M), rng.uniform(*SPEEDS_M_S)
    steps: list[dict[str, object]] = []
    left = minutes
    while left > 0.0:
        leg = min(left, rng.uniform(*LEG_MIN))
        step: dict[str, object] = {'name': f'leg {len(steps) + 1}', 'minutes': float(leg)}
        if steps and rng.uniform() < 0.5:
            step['speed_m_s'] = float(rng.uniform(*SPEEDS_M_S))
        elif steps:
            step['warp_length_m'] = float(rng.uniform(*LENGTHS_M))
        steps.append(step)
        left -= leg
    record = {
        'description': 'a tow in which something may begin',
        'gear': 'gear.yaml',
        'seed': int(rng.integers(2**31)),
        'refine': {'warp': 2, 'bridle': 2, 'unjoined': True},
        'start': {'warp_length_m': float(length), 'speed_m_s': float(speed)},
        'steps': steps,
        'truth_rate_hz': 2.0,
        'record': ['instruments'],
    }
    path = folder / COURSE
    write_text(path, yaml.safe_dump(record))
    return load_scenario(path)


def with_boards(scenario: Scenario, rng: np.random.Generator) -> Scenario:
    """The same course, of a plant with boards from the gear file's prior that tow it at rest; the
    model's are fastened alike.

    Raises
    ------
    TrawlError
        If none of those drawn tows.
    """
    states = tuple((command.port_length, command.speed) for _, command in scenario.commands)
    plant = draw_board(scenario.plant, states, rng).gear
    return replace(scenario, gear=fastened_as(scenario.gear, plant), plant=plant)


def towed_samples(scenario: Scenario, acting: EffectSet) -> Iterator[tuple[list[Sample], bool]]:
    """Samples of each truth of a tow, and whether a board of the plant has fallen there."""
    trial = Trial(scenario)
    suite = InstrumentSuite(
        scenario.instruments, surroundings=scenario.surroundings, draws=scenario.draws
    )
    seen = SensorEffects(acting, build_water(scenario.plant))
    while (truth := trial.step()) is not None:
        fallen = any(fallen_boards(trial.simulation.now.motion.state))
        yield [seen(sample) for sample in suite.observe(truth)], fallen
