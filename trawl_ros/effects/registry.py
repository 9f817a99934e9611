# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Catalogue of the known effects: those of `effects/catalogue`, and those of other packages.

Another package adds its own through an entry point of the group `trawl_ros.effects`, whose value is
an `Effect`.
"""

from collections.abc import Iterator, Mapping
from functools import cache
from importlib.metadata import entry_points
from types import MappingProxyType

from trawl_ros.core.errors import TrawlError
from trawl_ros.effects.base.effect import Effect
from trawl_ros.effects.catalogue import boards, instruments, net, ropes, water

ENTRY_POINT_GROUP = 'trawl_ros.effects'
"""Group of entry points; each has the name of its effect."""


@cache
def catalogue() -> Mapping[str, Effect]:
    """Return all effects by name, in the order of the names.

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
    for module in (boards, instruments, net, ropes, water):
        for effect in module.EFFECTS:
            yield module.__name__, effect


def _foreign() -> Iterator[tuple[str, Effect]]:
    for point in entry_points(group=ENTRY_POINT_GROUP):
        where = f'entry point {point.name} = {point.value}'
        try:
            effect = point.load()
        except (Exception, SystemExit) as reason:
            # A foreign module may raise anything when it is imported.
            raise TrawlError(f'{where}: cannot be loaded ({reason})') from reason
        if not isinstance(effect, Effect):
            raise TrawlError(f'{where}: found a {type(effect).__name__}, expected an Effect')
        yield where, effect
