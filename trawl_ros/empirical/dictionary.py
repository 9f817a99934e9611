"""Dictionary of all empirical terms."""

from collections.abc import Mapping
from functools import cache
from itertools import chain
from types import MappingProxyType

from trawl_ros.empirical.boards import board_terms
from trawl_ros.empirical.ropes import rope_terms
from trawl_ros.empirical.sensors import sensor_terms
from trawl_ros.empirical.term import Term


@cache
def dictionary() -> Mapping[str, Term]:
    """All empirical terms by name."""
    terms = chain(board_terms(), rope_terms(), sensor_terms())
    return MappingProxyType({term.name: term for term in terms})
