# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Names of a gear's parts in texts, in place of those of most gears."""

import re

from trawl_ros.gear.records import GearRecord


def own_parts(text: str, gear: GearRecord) -> str:
    """Return a text about a gear with the names of its own parts.

    A pair trawl has plates instead of boards or doors. A gear without clumps has weights at its
    lower wing tips.

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
