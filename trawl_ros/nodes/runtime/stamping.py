"""Header stamp of a message, read off its bytes without decoding the rest."""

from trawl_ros.messages.cdr import STORE
from trawl_ros.messages.stamps import ENCAPSULATION, stamp_in

MARKERS = 'visualization_msgs/msg/MarkerArray'


def header_stamp(type_name: str, data: bytes) -> int | None:
    """Return the stamp (ns) of a message's header; None where it has none.

    An array of markers has that of its first marker.
    """
    if type_name == MARKERS:
        # The header follows the number of markers.
        stamp = stamp_in(data, ENCAPSULATION + 4) if len(data) > 20 else None
    else:
        stamp = stamp_in(data) if _begins_with_header(type_name) else None
    return stamp if stamp is not None and stamp >= 0 else None


def _begins_with_header(type_name: str) -> bool:
    if type_name not in _KNOWN:
        kind = STORE.types.get(type_name)
        names = list(getattr(kind, '__dataclass_fields__', {}))
        _KNOWN[type_name] = names[:1] == ['header']
    return _KNOWN[type_name]


_KNOWN: dict[str, bool] = {}
