"""Decoders by the definitions that a bag carries: they, not ours, say how its bytes lie.

A database of Foxy to Humble carries none. There the distribution is found by trying: a type that
changed has another size, and a decoder takes nothing that is too short or too long.
"""

from collections.abc import Callable
from typing import Any

from rosbags.typesys import (
    Stores,
    TypesysError,
    get_types_from_idl,
    get_types_from_msg,
    get_typestore,
)
from rosbags.typesys.store import Typestore

from trawl_ros.bags.stored import Definition
from trawl_ros.errors import BagError
from trawl_ros.messages.cdr import DECODING_ERRORS, STORE

Decoder = Callable[[bytes], Any]

_IDL_SEPARATOR = '=' * 80 + '\n'

_WITHOUT_DEFINITIONS = (Stores.ROS2_HUMBLE, Stores.ROS2_GALACTIC, Stores.ROS2_FOXY)
"""Distributions whose databases carry no definitions, newest first."""


def make_decoder(topic: str, definition: Definition) -> Decoder:
    """Make what turns the bytes of a topic into messages.

    Raises
    ------
    BagError
        If the bag says neither in a way that can be understood, nor is the type known.
    """
    store = find_store(topic, definition)
    name = definition.type
    if definition.text:
        return lambda data: store.deserialize_cdr(data, name)
    return _Trying(name, store)


def find_store(topic: str, definition: Definition) -> Typestore:
    """Give the types of a topic as its bag defines them, or as ROS 2 does where it does not.

    Raises
    ------
    BagError
        As `make_decoder`.
    """
    if definition.message_encoding != 'cdr':
        raise BagError(
            f'{topic}: messages are encoded as {definition.message_encoding!r}; expected cdr'
        )
    name = definition.type
    if not definition.text and name in STORE.types:
        return STORE
    store = get_typestore(Stores.EMPTY)
    try:
        store.register(_parse(definition))
        if name in STORE.types and store.hash_rihs01(name) == STORE.hash_rihs01(name):
            return STORE
        store.get_msgdef(name)
    except (TypesysError, KeyError, RecursionError, SyntaxError, *DECODING_ERRORS) as reason:
        raise BagError(
            f'{topic}: the definition of {name or "its type"} in the bag cannot be understood '
            f'({type(reason).__name__}); expected ros2msg or ros2idl text'
        ) from reason
    return store


class _Trying:
    """Decodes by the first distribution whose definition fits, and stays with that."""

    def __init__(self, name: str, store: Typestore) -> None:
        self._name = name
        self._stores = [store]
        known = {store.hash_rihs01(name)}
        for older in map(get_typestore, _WITHOUT_DEFINITIONS):
            if name in older.types and older.hash_rihs01(name) not in known:
                known.add(older.hash_rihs01(name))
                self._stores.append(older)

    def __call__(self, data: bytes) -> Any:
        for store in tuple(self._stores):
            try:
                message = store.deserialize_cdr(data, self._name)
            except DECODING_ERRORS:
                if store is self._stores[-1]:
                    raise
            else:
                self._stores.remove(store)
                self._stores.insert(0, store)
                return message
        raise AssertionError('there is at least one store')


def _parse(definition: Definition) -> Any:
    text = definition.text.decode('utf-8')
    match definition.schema_encoding:
        case 'ros2msg':
            return get_types_from_msg(text, definition.type)
        case 'ros2idl':
            parts = [part for part in text.split(_IDL_SEPARATOR) if part.strip()]
            types: dict[str, Any] = {}
            for part in parts:
                body = part.partition('\n')[2] if part.startswith('IDL: ') else part
                types.update(get_types_from_idl(body))
            return types
    raise TypesysError(f'schema encoding {definition.schema_encoding!r}')
