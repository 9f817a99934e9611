"""Message classes of rclpy; the project itself handles bytes."""

from importlib import import_module
from typing import Any

from trawl_ros.core.errors import MessageError


def installed(type_name: str) -> bool:
    """True if the package of a type is installed."""
    try:
        message_class(type_name)
    except MessageError:
        return False
    return True


def message_class(type_name: str) -> Any:
    """Find the class of a type such as ``sensor_msgs/msg/JointState``.

    Raises
    ------
    MessageError
        If no installed package has it.
    """
    parts = type_name.split('/')
    if len(parts) == 3 and all(part.isidentifier() for part in parts):
        package, kind, name = parts
        try:
            return getattr(import_module(f'{package}.{kind}'), name)
        except (ImportError, AttributeError):
            pass
    raise MessageError(
        f'{type_name}: no installed package has this message type; expected one such as '
        'sensor_msgs/msg/JointState'
    )
