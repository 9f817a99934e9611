# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Findings of a tow that goes on: what has begun, when, how large, and what else fits."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from trawl_ros.core.time import SECOND

State = Literal['raised', 'settled', 'withdrawn', 'dismissed']
"""Raised and followed; of another half hour of evidence; not borne out; not so by the operator."""


@dataclass(frozen=True)
class OnsetValue:
    """Value of an effect that has begun, with the ends of its 95 % interval."""

    value: float
    low: float
    high: float
    unit: str


@dataclass(frozen=True)
class Finding:
    """Finding: an effect, or a pattern of a channel, that has begun during a tow.

    Attributes
    ----------
    number
        Of the finding, 1 for the first.
    state
        Of it.
    raised_ns, updated_ns
        Ends of the stretches by which it was raised, and by which it is as it stands.
    onset_ns, onset_low_ns, onset_high_ns
        Onset, with the ends of its 95 % interval.
    name, words
        The likeliest, and that in words.
    values
        Of it, by parameter.
    alike
        Names of all others with similar evidence.
    rarity, limit
        -log10 of the probability of as much evidence at one onset by chance, and what it has to be
        beyond.

    Examples
    --------
    >>> from trawl_ros.diagnosis.onset.findings import Finding
    >>> found = Finding(1, 'raised', 600, 600, 0, 0, 60, 'kite', 'It is lost', {}, (), 9.0, 8.0)
    >>> found.open
    True
    """

    number: int
    state: State
    raised_ns: int
    updated_ns: int
    onset_ns: int
    onset_low_ns: int
    onset_high_ns: int
    name: str
    words: str
    values: Mapping[str, OnsetValue]
    alike: tuple[str, ...]
    rarity: float
    limit: float

    @property
    def open(self) -> bool:
        """True while it may still change."""
        return self.state == 'raised'

    @property
    def delay_s(self) -> float:
        """Time from the onset to when it was raised, s."""
        return (self.raised_ns - self.onset_ns) / SECOND

    def sentence(self) -> str:
        """Finding in one sentence."""
        ago = (self.updated_ns - self.onset_ns) / SECOND / 60.0
        wide = (self.onset_high_ns - self.onset_low_ns) / SECOND / 60.0
        also = f'; similar evidence for {", ".join(self.alike)}' if self.alike else ''
        sizes = ', '.join(
            f'{name} {one.value:.3g} ({one.low:.3g} to {one.high:.3g}) {one.unit}'.rstrip()
            for name, one in self.values.items()
        )
        return f'{self.name} has begun {ago:.1f} min ago (within {wide:.1f} min): {sizes}{also}'
