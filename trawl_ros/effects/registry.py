"""Catalogue of the known effects: those of the folder `catalogue`, and those of other packages.

Another package adds its own through an entry point of the group `trawl_ros.effects`, whose value is
an `Effect`.
"""

from collections.abc import Iterator, Mapping
from functools import cache
from importlib import import_module
from importlib.metadata import entry_points
from pkgutil import walk_packages
from types import MappingProxyType

import trawl_ros.effects.catalogue
from trawl_ros.core.errors import TrawlError
from trawl_ros.effects.base.effect import Effect

GROUP = 'trawl_ros.effects'
"""Of entry points; each has the name of its effect."""


@cache
def catalogue() -> Mapping[str, Effect]:
    """All effects by name, in the order of the names.

    Returns
    -------
    Mapping
        Name → `Effect`; read only.

    Raises
    ------
    TrawlError
        If an entry point cannot be loaded, is no effect, or has a name that is taken.

    Examples
    --------
    >>> import trawl_ros
    >>> effect = trawl_ros.catalogue()['warp_strumming']
    >>> effect.sentence
    'The warps vibrate in the flow, or are fouled, and meet more drag across them.'
    """
    found: dict[str, Effect] = {}
    for source, effect in (*_own(), *_foreign()):
        if effect.name in found:
            raise TrawlError(f'{source}: the name {effect.name} is taken, expected another')
        found[effect.name] = effect
    return MappingProxyType(dict(sorted(found.items())))


def _own() -> Iterator[tuple[str, Effect]]:
    folder = trawl_ros.effects.catalogue
    for module in walk_packages(folder.__path__, f'{folder.__name__}.'):
        own = import_module(module.name)
        for effect in getattr(own, 'EFFECTS', (getattr(own, 'EFFECT', None),)):
            if isinstance(effect, Effect):
                yield module.name, effect


def _foreign() -> Iterator[tuple[str, Effect]]:
    for point in entry_points(group=GROUP):
        where = f'entry point {point.name} = {point.value}'
        try:
            effect = point.load()
        except (Exception, SystemExit) as reason:
            # Whatever a foreign module does when it is imported is not this program's fault.
            raise TrawlError(f'{where}: cannot be loaded ({reason})') from reason
        if not isinstance(effect, Effect):
            raise TrawlError(f'{where}: found a {type(effect).__name__}, expected an Effect')
        yield where, effect
