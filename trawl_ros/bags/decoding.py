"""Decoders by the definitions that a bag carries: they, not ours, say how its bytes lie."""

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

from trawl_ros.bags.mcap_file import Definition
from trawl_ros.errors import BagError
from trawl_ros.messages.cdr import DECODING_ERRORS, STORE

Decoder = Callable[[bytes], Any]

_IDL_SEPARATOR = '=' * 80 + '\n'


def make_decoder(topic: str, definition: Definition) -> Decoder:
    """Make what turns the bytes of a topic into messages.

    Raises
    ------
    BagError
        If the bag says neither in a way that can be understood, nor is the type known.
    """
    if definition.message_encoding != 'cdr':
        raise BagError(
            f'{topic}: messages are encoded as {definition.message_encoding!r}; expected cdr'
        )
    store = _store(topic, definition)
    name = definition.type
    return lambda data: store.deserialize_cdr(data, name)


def _store(topic: str, definition: Definition) -> Typestore:
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
