"""Names of a gear's own parts, in place of those that most gears have."""

import re

from trawl_ros.gear.records import GearRecord


def own_parts(text: str, gear: GearRecord) -> str:
    """Text about a gear with the names of its own parts.

    Two ships tow plates where one tows boards or doors, and without a clump a weight at the lower
    wing tips is one of these.

    Examples
    --------
    >>> import trawl_ros
    >>> from trawl_ros.gear.parts import own_parts
    >>> own_parts('door spread; clump 300 N', trawl_ros.load_gear('pair_368'))
    'plate spread; lower wing tip 300 N'
    """
    names: dict[str, str] = {}
    if gear.pair is not None:
        names |= {'door': 'plate', 'doors': 'plates', 'board': 'plate', 'boards': 'plates'}
    if gear.clump.weight_in_water_n == 0.0:
        names |= {'clump': 'lower wing tip', 'clumps': 'lower wing tips'}
    for name, own in names.items():
        text = re.sub(rf'\b{name}\b', own, text)
    return text
