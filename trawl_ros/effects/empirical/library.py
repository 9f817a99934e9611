"""Dictionary of all empirical terms."""

from collections.abc import Mapping
from functools import cache
from itertools import chain
from types import MappingProxyType

from trawl_ros.effects.base.term import EmpiricalTerm


@cache
def dictionary() -> Mapping[str, EmpiricalTerm]:
    """All empirical terms by name."""
    # Imported when asked for, as the catalogue is: they bring the model, and most gears have none.
    from trawl_ros.effects.empirical.boards import board_terms
    from trawl_ros.effects.empirical.ropes import rope_terms
    from trawl_ros.effects.empirical.sensors import sensor_terms

    terms = chain(board_terms(), rope_terms(), sensor_terms())
    return MappingProxyType({term.name: term for term in terms})
