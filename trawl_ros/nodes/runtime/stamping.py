"""Header stamp of a message, read off its bytes without decoding the rest."""

import struct

from trawl_ros.core.time import SECOND
from trawl_ros.messages.cdr import STORE

MARKERS = 'visualization_msgs/msg/MarkerArray'
_ENCAPSULATION = 4
_ORDERS = {0: '>', 1: '<'}


def stamp_in(type_name: str, data: bytes) -> int | None:
    """Return the stamp (ns) of a message's header; None where it has none.

    An array of markers has that of its first marker.
    """
    if type_name == MARKERS:
        # The header follows the number of markers.
        return _time_at(data, _ENCAPSULATION + 4) if len(data) > 20 else None
    return _time_at(data, _ENCAPSULATION) if _begins_with_header(type_name) else None


def _begins_with_header(type_name: str) -> bool:
    if type_name not in _KNOWN:
        kind = STORE.types.get(type_name)
        names = list(getattr(kind, '__dataclass_fields__', {}))
        _KNOWN[type_name] = names[:1] == ['header']
    return _KNOWN[type_name]


_KNOWN: dict[str, bool] = {}


def _time_at(data: bytes, offset: int) -> int | None:
    try:
        seconds, nanoseconds = struct.unpack_from(_ORDERS[data[1]] + 'iI', data, offset)
    except (struct.error, KeyError, IndexError):
        return None
    return seconds * SECOND + nanoseconds if seconds >= 0 else None
