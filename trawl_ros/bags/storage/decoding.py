# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Decoders from the definitions in a bag, which define the layout of its bytes.

A database of Foxy to Humble has no definitions. Its distribution is found by trial: a type that
changed has another size, and a decoder accepts neither too few nor too many bytes.
"""

import math
from collections.abc import Callable
from functools import cache
from typing import Any

from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.store import Typestore

from trawl_ros.bags.storage.definitions import make_store, objects_per_byte, parse_definition
from trawl_ros.bags.storage.stored import Definition
from trawl_ros.core.errors import BagError, MessageError
from trawl_ros.core.foreign import one_line, short
from trawl_ros.core.limits import BAG_FIELDS, MESSAGE_OBJECTS
from trawl_ros.messages.cdr import DECODING_ERRORS, STORE
from trawl_ros.messages.cdr import message_definition as known_text

Decoder = Callable[[bytes], Any]
"""Decoder of bytes into a message; it raises `MessageError` if they do not match."""

_WITHOUT_DEFINITIONS = (Stores.ROS2_HUMBLE, Stores.ROS2_GALACTIC, Stores.ROS2_FOXY)
"""Distributions whose databases have no definitions, newest first."""


class BagTypes:
    """Types of a bag by its definitions, or by ROS 2's where there are none."""

    def __init__(self) -> None:
        self._stores: dict[tuple[str, str, bytes], Typestore | BagError] = {}
        self._fields = 0

    def decoder(self, topic: str, definition: Definition) -> Decoder:
        """Return the decoder of a topic's bytes.

        Raises
        ------
        BagError
            If the bag says neither in a way that can be understood, nor is the type known.
        """
        store = self.store(topic, definition)
        name = definition.type
        most = _most_bytes(name) if store is STORE else _most_bytes(name, store)
        decode = _Trying(name, store) if not definition.text else store.deserialize_cdr

        def decoded(data: bytes) -> Any:
            try:
                if len(data) > most:
                    raise ValueError(f'may hold more than {MESSAGE_OBJECTS} objects')
                return decode(data, name)
            # Whatever generated code raises when bytes are not what the type says.
            except Exception as reason:
                raise MessageError(
                    f'{topic}: {len(data)} bytes are not a {name} ({reason})'
                ) from reason

        return decoded

    def store(self, topic: str, definition: Definition) -> Typestore:
        """Return the types of a topic.

        Raises
        ------
        BagError
            As `decoder`.
        """
        if definition.message_encoding != 'cdr':
            raise BagError(
                f'{topic}: messages are encoded as '
                f'{one_line(definition.message_encoding, 120)!r}; expected cdr'
            )
        key = definition.type, definition.schema_encoding, definition.text
        if key not in self._stores:
            try:
                self._stores[key] = self._make(definition)
            except BagError as reason:
                self._stores[key] = reason
        store = self._stores[key]
        if isinstance(store, BagError):
            raise BagError(f'{topic}: {store}')
        return store

    def _make(self, definition: Definition) -> Typestore:
        name = definition.type
        if name in STORE.types and definition.text in (b'', _text(name)):
            return STORE
        try:
            types = parse_definition(definition)
            self._fields += sum(len(fields) for _, fields in types.values())
            if self._fields > BAG_FIELDS.value:
                raise ValueError(f'{self._fields} with those before; expected {BAG_FIELDS} at most')
            store = make_store(types)
            if name in STORE.types and store.hash_rihs01(name) == STORE.hash_rihs01(name):
                return STORE
            store.get_msgdef(name)
        except Exception as reason:
            raise BagError(
                f'the definition of {one_line(name, 120) or "its type"} in the bag cannot be '
                f'understood ({short(reason)}); expected ros2msg or ros2idl text'
            ) from reason
        return store


@cache
def _text(name: str) -> bytes:
    return known_text(name).encode()


@cache
def _most_bytes(name: str, store: Typestore = STORE) -> float:
    """Largest size of a message that stays within the limit of objects."""
    density = objects_per_byte(store.fielddefs, name)
    return MESSAGE_OBJECTS.value / density if density else math.inf


class _Trying:
    """Decoder with the first distribution whose definition fits; later calls keep it."""

    def __init__(self, name: str, store: Typestore) -> None:
        self._stores = [store]
        known = {store.hash_rihs01(name)}
        for older in map(get_typestore, _WITHOUT_DEFINITIONS):
            if name in older.types and older.hash_rihs01(name) not in known:
                known.add(older.hash_rihs01(name))
                self._stores.append(older)

    def __call__(self, data: bytes, name: str) -> Any:
        for store in tuple(self._stores):
            try:
                message = store.deserialize_cdr(data, name)
            except DECODING_ERRORS:
                if store is self._stores[-1]:
                    raise
            else:
                self._stores.remove(store)
                self._stores.insert(0, store)
                return message
        raise AssertionError('there is at least one store')
