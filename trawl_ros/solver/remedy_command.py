"""Command that computes what would make a refused tow usable."""

import re

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.resources import share_path
from trawl_ros.gear.records import GearRecord
from trawl_ros.solver.operating_point import OperatingPoint


def remedy_command(gear: GearRecord, point: OperatingPoint) -> str:
    """Sentence that names the command, for the mean length of the warps.

    A gear of the package is named; of others the record does not know its file.
    """
    warp = 0.5 * (point.port_length + point.starboard_length)
    name, file = gear.name, ''
    if not _packaged(name):
        name, file = 'GEAR', ", with the gear's file for GEAR,"
    command = f'trawl gear state {name} --warp {warp:g} --speed {point.speed:g}'
    return f'`{command}`{file} computes what would make it usable'


def _packaged(name: str) -> bool:
    if not re.fullmatch(r'\w+', name):
        return False
    try:
        return share_path('config', 'gear', f'{name}.yaml').is_file()
    except TrawlError:
        return False
