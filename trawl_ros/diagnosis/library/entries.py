# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Hypotheses that a diagnosis of one gear compares: entries of the library at their nodes."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from trawl_ros.core.errors import TrawlError
from trawl_ros.diagnosis.library.drift import drifts
from trawl_ros.diagnosis.library.gear_file_change import changes_of
from trawl_ros.diagnosis.library.table import NodeRecord, hypothesis_table
from trawl_ros.effects.base.effect import Effect
from trawl_ros.effects.empirical import dictionary
from trawl_ros.effects.registry import catalogue
from trawl_ros.gear.records import GearRecord

OTHER_CAUSES = NodeRecord(
    path='other causes',
    rate=1.0,
    reason='an effect of another package, which no table has',
    check='Compare the gear with its drawing.',
)


@dataclass(frozen=True)
class Entry:
    """Hypothesis of the library.

    Attributes
    ----------
    name
        Name of the leaf in the tree of causes.
    node
        Its place in the tree.
    effect
        Implementation: an effect, a change of the gear file, or a drift.
    places
        Places of those of the effect's parameters that may differ.
    rate
        Prior probability that an examined trial has this cause.
    """

    name: str
    node: NodeRecord
    effect: Effect
    places: tuple[int, ...]
    rate: float

    @property
    def log_odds(self) -> float:
        """Logarithm of the prior odds."""
        return float(np.log(self.rate / (1.0 - self.rate)))

    @property
    def path(self) -> str:
        """Path of the leaf."""
        return f'{self.node.path}/{self.name}'

    @property
    def check(self) -> str:
        """Check on deck, in one sentence."""
        return self.effect.direct or self.node.check


def library(
    gear: GearRecord, effects: Mapping[str, Effect] | None = None, *more: Path
) -> tuple[Entry, ...]:
    """Return all hypotheses on a gear.

    Parameters
    ----------
    gear
        Gear as it is believed.
    effects
        Effects of the catalogue that are possible; all of them if None.
    more
        Tables in addition to those of the package.

    Raises
    ------
    TrawlError
        If a row names an effect that there is not, or a parameter that it does not have.
    """
    table = hypothesis_table(*more)
    possible = catalogue() if effects is None else effects
    nodes = {node.path: node for node in table.nodes}
    known: Mapping[str, Effect] = {
        **catalogue(), **dictionary(), **{drift.name: drift for drift in drifts()}
    }  # fmt: skip
    found: list[tuple[str, NodeRecord, Effect, tuple[int, ...]]] = []
    for row in table.entries:
        if row.keys:
            continue
        effect = known.get(row.effect or row.name)
        if effect is None:
            raise TrawlError(
                f'entries.{row.name}.effect: found {row.effect or row.name}, expected an effect of '
                'the catalogue, an empirical term or a drift'
            )
        if effect.name in catalogue() and effect.name not in possible:
            continue
        found.append((row.name, nodes[row.at], effect, _places(row.name, effect, row.parameters)))
    listed = {effect.name for _, _, effect, _ in found} | {row.name for row in table.entries}
    for name, effect in possible.items():
        if effect.fitted and name not in listed:
            found.append((name, OTHER_CAUSES, effect, tuple(range(len(effect.parameters)))))
    at = {row.name: nodes[row.at] for row in table.entries}
    found += [
        (change.name, at[change.record.name], change, (0,)) for change in changes_of(gear, *more)
    ]
    number = Counter(node.path for _, node, _, _ in found)
    return tuple(
        Entry(name, node, effect, places, node.rate / 100.0 / number[node.path])
        for name, node, effect, places in found
    )


def _places(row: str, effect: Effect, wanted: tuple[str, ...]) -> tuple[int, ...]:
    names = [parameter.name for parameter in effect.parameters]
    for name in wanted:
        if name not in names:
            raise TrawlError(
                f'entries.{row}.parameters: found {name}, expected one of {", ".join(names)}'
            )
    return tuple(place for place, name in enumerate(names) if not wanted or name in wanted)
