"""Scenario of a long tow: quiet but not at rest, with warps hauled and veered now and then."""

from pathlib import Path
from shutil import copyfile

import yaml

from trawl_ros.core.files import write_text
from trawl_ros.lab.trials.linearised_plant import MeshResolution

COARSEST = 12
"""Meshes around the mouth of the coarsest net there is, towed several times faster."""

TRUTH_HZ = 2.0
LEG_MINUTES = 30.0
LEGS = (
    {'name': 'hold', 'warp_length_m': 400.0, 'speed_m_s': 2.0},
    {'name': 'haul', 'warp_length_m': 380.0, 'speed_m_s': 2.05},
)


def write_coarse_gear(folder: Path, gear: str) -> str:
    """Write a gear with its netting as coarse as it may be, and give the file's path."""
    path = folder / 'coarse.yaml'
    write_text(
        path,
        yaml.safe_dump(
            MeshResolution(COARSEST).model(gear).model_dump(mode='json'), sort_keys=False
        ),
    )
    return str(path)


def write_long_tow(folder: Path, gear: str, hours: float, truth_rate_hz: float = TRUTH_HZ) -> Path:
    """Write the scenario of a long tow.

    Parameters
    ----------
    folder
        Takes the scenario, and a copy of the gear where that is a file.
    gear
        Gear file, or the name of one that comes with the package.
    hours
        Length of the tow.
    truth_rate_hz
        Rate of truth, Hz.

    Returns
    -------
    Path
        The scenario's file.
    """
    if gear.endswith(('.yaml', '.yml')):
        gear = copyfile(gear, folder / 'gear.yaml').name
    minutes = 60.0 * hours
    leg = min(LEG_MINUTES, minutes / 4)
    number = max(1, round(minutes / leg))
    record = {
        'description': f'{hours:g} hours of quiet towing, hauling and veering now and then',
        'gear': gear,
        'seed': 4,
        'start': {key: value for key, value in LEGS[0].items() if key != 'name'},
        'steps': [
            {**LEGS[step % len(LEGS)], 'minutes': minutes / number} for step in range(number)
        ],
        'truth_rate_hz': truth_rate_hz,
        # Not fitted by default; here every topic is heard.
        'instruments': {'door': {'slant_range': {'rate_hz': 0.5, 'noise_m': 1.0}}},
    }
    path = folder / 'long_tow.yaml'
    write_text(path, yaml.safe_dump(record, sort_keys=False))
    return path
