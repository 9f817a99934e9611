"""Plants of the trials: a random course, boards drawn from the gear file's prior, and what is known
of them.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import yaml

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.files import write_text
from trawl_ros.diagnosis.onset.knowledge import Knowledge
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.gear.boards import CoefficientsRecord
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.studies.identification.plant import draw_board
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.scenario.scenario import Scenario, load_scenario

KNOWN = 0.2
"""Std of the boards as they are known when the tow begins, in that of the gear file's prior: five
steady states tell as much."""

LENGTHS_M, SPEEDS_M_S = (320.0, 480.0), (2.1, 2.45)
LEG_MIN = (3.0, 9.0)


def knowledge(gear: GearRecord, truth: FloatArray, chance: np.random.Generator) -> Knowledge:
    """Boards as they are known: the truth, wrong by as much as is stated, within their bounds.

    Parameters
    ----------
    gear
        Gear whose prior says how large `KNOWN` is.
    truth
        Coefficients (12,) of the plant.
    chance
        Generator of random numbers.
    """
    prior = board_prior(gear)
    std = KNOWN * prior.std
    values = truth + std * chance.standard_normal(len(std))
    return Knowledge(np.clip(values, prior.low, prior.high), np.diag(std**2))


def random_course(
    folder: Path, gear: GearRecord, minutes: float, chance: np.random.Generator
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
    chance
        Generator of random numbers.
    """
    write_text(folder / 'gear.yaml', yaml.safe_dump(gear.model_dump(mode='json')))
    length, speed = chance.uniform(*LENGTHS_M), chance.uniform(*SPEEDS_M_S)
    steps: list[dict[str, object]] = []
    left = minutes
    while left > 0.0:
        leg = min(left, chance.uniform(*LEG_MIN))
        step: dict[str, object] = {'name': f'leg {len(steps) + 1}', 'minutes': float(leg)}
        if steps and chance.uniform() < 0.5:
            step['speed_m_s'] = float(chance.uniform(*SPEEDS_M_S))
        elif steps:
            step['warp_length_m'] = float(chance.uniform(*LENGTHS_M))
        steps.append(step)
        left -= leg
    record = {
        'description': 'a tow in which something may begin',
        'gear': 'gear.yaml',
        'seed': int(chance.integers(2**31)),
        'refine': {'warp': 2, 'bridle': 2, 'unjoined': True},
        'start': {'warp_length_m': float(length), 'speed_m_s': float(speed)},
        'steps': steps,
        'truth_rate_hz': 2.0,
        'record': ['instruments'],
    }
    path = folder / 'scenario.yaml'
    write_text(path, yaml.safe_dump(record))
    return load_scenario(path)


def with_boards(scenario: Scenario, chance: np.random.Generator) -> Scenario:
    """The same course, of a plant with boards from the gear file's prior that tow it at rest.

    Raises
    ------
    TrawlError
        If none of those drawn tows.
    """
    states = tuple((command.port_length, command.speed) for _, command in scenario.commands)
    drawn = draw_board(scenario.plant, board_prior(scenario.gear), (states,), chance)
    board = CoefficientsRecord(**dict(zip(COEFFICIENTS, drawn.coefficients.tolist(), strict=True)))
    plant = scenario.plant
    own = plant.model_copy(update={'board': plant.board.model_copy(update={'coefficients': board})})
    return replace(scenario, plant=own)
