# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Faults of sensors on command: their kinds, places and switching.

A fault is written as a word and, if it has a size, a number in the SI unit of the quantity:
``frozen``, ``offset -3.5``, ``scale 1.02``. Its place is a whole instrument (topic) or one of its
quantities (topic/quantity).
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Protocol

from trawl_ros.core.errors import InstrumentError

NONE = 'none'


@dataclass(frozen=True)
class FaultKind:
    """Kind of fault: its description, and the range of its size if it has one."""

    sentence: str
    low: float | None = None
    high: float = math.inf

    @property
    def sized(self) -> bool:
        """True for a kind with a size."""
        return self.low is not None


OF_QUANTITIES: Mapping[str, FaultKind] = MappingProxyType(
    {
        'frozen': FaultKind('the reading does not change'),
        'lost': FaultKind('the reading is NaN'),
        'offset': FaultKind('this value is added to the reading', -math.inf),
        'scale': FaultKind('the reading is multiplied by this factor', -math.inf),
        'drift': FaultKind('the error grows by this value per hour', -math.inf),
        'noise': FaultKind('normal noise of this standard deviation is added', 0.0),
        'outliers': FaultKind('this share of the readings is far from the truth', 0.0, 1.0),
        'saturated': FaultKind('no reading exceeds this value', -math.inf),
    }
)
"""Faults of a quantity; on a whole instrument they act on all of its quantities."""

OF_INSTRUMENTS: Mapping[str, FaultKind] = MappingProxyType(
    {
        'silent': FaultKind('nothing is sent'),
        'dropouts': FaultKind(
            'nothing is sent for this share of the time, in bursts of 10 s', 0.0, 0.99
        ),
        'late': FaultKind('samples are sent this many seconds later', 0.0, 3600.0),
        'jitter': FaultKind('sampling times vary with this standard deviation, s', 0.0, 60.0),
    }
)
"""Faults of a whole instrument."""

KINDS: Mapping[str, FaultKind] = MappingProxyType({**OF_QUANTITIES, **OF_INSTRUMENTS})


@dataclass(frozen=True)
class Fault:
    """Fault: a kind and its size (NaN if it has none)."""

    kind: str
    size: float = math.nan

    def __str__(self) -> str:
        return f'{self.kind} {self.size:g}' if KINDS[self.kind].sized else self.kind


def parse_fault(text: str) -> Fault | None:
    """Parse a fault such as ``offset -3.5``; None for ``none``.

    Raises
    ------
    InstrumentError
        If there is no such fault, or its size is missing, not a number or out of range.
    """
    word, _, size = text.strip().partition(' ')
    if word == NONE and not size:
        return None
    if word not in KINDS:
        raise InstrumentError(
            f"fault '{text}': no such fault; expected one of {', '.join(KINDS)}, or {NONE}"
        )
    kind = KINDS[word]
    if not kind.sized:
        if size.strip():
            raise InstrumentError(
                f"fault '{text}': found a size, but {word} has none; expected '{word}'"
            )
        return Fault(word)
    try:
        number = float(size)
    except ValueError:
        number = math.nan
    low = -math.inf if kind.low is None else kind.low
    if not (math.isfinite(number) and low <= number <= kind.high):
        bounds = '' if low == -math.inf else f' from {low:g} to {kind.high:g}'
        raise InstrumentError(
            f"fault '{text}': found size '{size}', expected a number{bounds}: {kind.sentence}"
        )
    return Fault(word, number)


class Faulty(Protocol):
    """Instrument that can have faults."""

    @property
    def name(self) -> str:
        """Topic of the instrument."""

    @property
    def quantities(self) -> Sequence[str]:
        """Names of its quantities."""

    def put(self, fault: Fault, quantity: str | None) -> None:
        """Activate a fault; one of the same kind is replaced."""

    def take_off(self, kind: str, quantity: str | None) -> None:
        """Deactivate one kind of fault."""

    def clear(self, quantity: str | None) -> None:
        """Deactivate all faults of a quantity, or all there are."""

    def faults(self) -> dict[str, tuple[Fault, ...]]:
        """Return the active faults by topic or topic/quantity."""


class FaultPanel:
    """Fault panel: activates and deactivates faults of several instruments.

    Parameters
    ----------
    instruments
        Instruments with different names.
    """

    def __init__(self, instruments: Sequence[Faulty]) -> None:
        self._instruments = {instrument.name: instrument for instrument in instruments}

    @property
    def places(self) -> tuple[str, ...]:
        """Possible places of faults: topics, and topics with a quantity."""
        found = []
        for name, instrument in self._instruments.items():
            found.append(name)
            if len(instrument.quantities) > 1:
                found += [f'{name}/{quantity}' for quantity in instrument.quantities]
        return tuple(found)

    def knows(self, where: str) -> bool:
        """Return True if a place belongs to one of these instruments."""
        return self._place(where) is not None

    def check(self, where: str, what: str) -> tuple[Faulty, str | None, Fault | None]:
        """Parse place and fault without activating anything.

        Raises
        ------
        InstrumentError
            If there is no such place or fault, or the place cannot have the fault.
        """
        place = self._place(where)
        if place is None:
            raise InstrumentError(
                f"fault at '{where}': no such place; expected one of {', '.join(self.places)}"
            )
        instrument, quantity = place
        fault = parse_fault(what)
        if fault is None:
            return instrument, quantity, None
        if quantity is not None and fault.kind in OF_INSTRUMENTS:
            raise InstrumentError(
                f"fault at '{where}': found {fault.kind}, a fault of a whole instrument; expected "
                f"the place '{instrument.name}'"
            )
        if not instrument.quantities and fault.kind in OF_QUANTITIES:
            raise InstrumentError(
                f"fault at '{where}': found {fault.kind}, a fault of a quantity, but this "
                f'instrument has none; expected one of {", ".join(OF_INSTRUMENTS)}'
            )
        return instrument, quantity, fault

    def switch(self, where: str, what: str) -> None:
        """Activate a fault at a place, or deactivate all of its faults with ``none``.

        Raises
        ------
        InstrumentError
            As `check`.
        """
        instrument, quantity, fault = self.check(where, what)
        if fault is None:
            instrument.clear(quantity)
        else:
            instrument.put(fault, quantity)

    def switch_off(self, where: str, what: str) -> None:
        """Deactivate one fault that `switch` has activated; other faults stay active."""
        place, fault = self._place(where), parse_fault(what)
        if place is not None and fault is not None:
            instrument, quantity = place
            instrument.take_off(fault.kind, quantity)

    def active(self) -> dict[str, str]:
        """Return the active faults by place."""
        return {
            place: ', '.join(map(str, faults))
            for instrument in self._instruments.values()
            for place, faults in instrument.faults().items()
        }

    def _place(self, where: str) -> tuple[Faulty, str | None] | None:
        for name, instrument in self._instruments.items():
            if where == name:
                return instrument, None
            quantity = where.removeprefix(f'{name}/')
            if quantity != where and quantity in instrument.quantities:
                return instrument, quantity
        return None
