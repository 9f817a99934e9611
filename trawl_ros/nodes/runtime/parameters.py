# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Parameters of nodes: each with a unit, a range and a sentence, checked whenever it is set."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any

from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    SetParametersResult,
)
from rclpy.exceptions import InvalidParameterValueException
from rclpy.node import Node
from rclpy.parameter import Parameter

from trawl_ros.core.errors import TrawlError
from trawl_ros.nodes.runtime.connected_node import ConnectedNode
from trawl_ros.records.frames import FRAME_SENTENCES

FIXED = 'read at the start; restart the node to change it'

OWN_TO_ROS = ('use_sim_time', 'start_type_description_service', 'qos_overrides.')
"""Beginnings of the names of parameters that every node has from ROS itself."""

OF_FRAMES = ('publish_tf', *(f'{frame}_frame' for frame in FRAME_SENTENCES))
"""Parameters of frames, which one file gives to all nodes of a ship."""


class ParameterError(TrawlError):
    """A parameter of a node that is of the wrong kind or out of its range."""


@dataclass(frozen=True)
class Number:
    """Numeric parameter in ``unit`` from ``low`` to ``high``; ``whole`` asks for an integer.

    ``live`` says that a change at run time has effect; others are refused.
    """

    name: str
    default: float
    unit: str
    low: float
    high: float
    sentence: str
    live: bool = False
    whole: bool = False

    def descriptor(self) -> ParameterDescriptor:
        """Return the descriptor for ROS tools."""
        descriptor = _descriptor(f'{self.sentence} ({self.unit})', self.live)
        if self.whole:
            bounds = IntegerRange(from_value=int(self.low), to_value=int(self.high), step=0)
            descriptor.integer_range = [bounds]
        else:
            descriptor.floating_point_range = [
                FloatingPointRange(from_value=self.low, to_value=self.high, step=0.0)
            ]
        return descriptor

    def checked(self, value: Any) -> float:
        """Return the checked number, an int as well as a double."""
        kinds: tuple[type, ...] = (int,) if self.whole else (int, float)
        kind = 'a whole number' if self.whole else 'a number'
        good = isinstance(value, kinds) and not isinstance(value, bool)
        if not good or not (math.isfinite(value) and self.low <= value <= self.high):
            raise ParameterError(
                f'parameter {self.name}: found {value!r}, expected {kind} from {self.low:g} to '
                f'{self.high:g} ({self.unit})'
            )
        return int(value) if self.whole else float(value)


@dataclass(frozen=True)
class Flag:
    """Boolean parameter."""

    name: str
    default: bool
    sentence: str
    live: bool = False

    def descriptor(self) -> ParameterDescriptor:
        """Return the descriptor for ROS tools."""
        return _descriptor(self.sentence, self.live)

    def checked(self, value: Any) -> bool:
        """Return the checked flag."""
        if not isinstance(value, bool):
            raise ParameterError(f'parameter {self.name}: found {value!r}, expected true or false')
        return value


@dataclass(frozen=True)
class Text:
    """Text parameter, one of ``choices`` where there are any; ``needed`` refuses an empty one."""

    name: str
    default: str
    sentence: str
    choices: tuple[str, ...] = ()
    needed: bool = False
    live: bool = False

    def descriptor(self) -> ParameterDescriptor:
        """Return the descriptor for ROS tools."""
        listed = f' (one of {", ".join(self.choices)})' if self.choices else ''
        return _descriptor(self.sentence + listed, self.live)

    def checked(self, value: Any) -> str:
        """Return the checked text."""
        if not isinstance(value, str):
            raise ParameterError(f'parameter {self.name}: found {value!r}, expected text')
        if self.needed and not value:
            raise ParameterError(f'parameter {self.name}: missing; {self.sentence}')
        if self.choices and value not in self.choices:
            raise ParameterError(
                f'parameter {self.name}: found {value!r}, expected one of {", ".join(self.choices)}'
            )
        return value


@dataclass(frozen=True)
class Names:
    """Parameter of a list of texts; a single one may stand without brackets."""

    name: str
    sentence: str
    default: tuple[str, ...] = ()
    live: bool = False

    def descriptor(self) -> ParameterDescriptor:
        """Return the descriptor for ROS tools."""
        return _descriptor(f'{self.sentence} (list)', self.live)

    def checked(self, value: Any) -> tuple[str, ...]:
        """Return the checked list."""
        if value is None or value == '':
            return ()
        listed = [value] if isinstance(value, str) else list(value)
        if not all(isinstance(item, str) and item for item in listed):
            raise ParameterError(
                f'parameter {self.name}: found {value!r}, expected a list of texts'
            )
        return tuple(listed)


Spec = Number | Flag | Text | Names


class Parameters:
    """Parameters of a node with their present values by name.

    Parameters
    ----------
    node
        The node.
    specs
        Their specifications.
    objection
        Says why a new value of a live parameter cannot be taken, or None.
    changed
        Called with the name after a live parameter has its new value.

    Raises
    ------
    ParameterError
        If a value given at the start is of the wrong kind or out of range.
    """

    def __init__(
        self,
        node: ConnectedNode,
        specs: Sequence[Spec],
        objection: Callable[[str, Any], str | None],
        changed: Callable[[str], None],
    ) -> None:
        self._specs = {spec.name: spec for spec in specs}
        self._values: dict[str, Any] = {}
        # Another thread may set a parameter while a callback uses it.
        self._turns = node.turns
        self._objection = objection
        self._changed = changed
        for spec in specs:
            # An empty list has no type that ROS would know, so it stands as an empty text.
            default = (list(spec.default) or '') if isinstance(spec, Names) else spec.default
            try:
                given = node.declare_parameter(spec.name, default, spec.descriptor())
            except InvalidParameterValueException as reason:
                raise ParameterError(f'{node.get_fully_qualified_name()}: {reason}') from reason
            try:
                self._values[spec.name] = spec.checked(given.value)
            except ParameterError as reason:
                raise ParameterError(f'{node.get_fully_qualified_name()}: {reason}') from None
        node.add_on_set_parameters_callback(self._check)
        node.add_post_set_parameters_callback(self._take)

    def __getitem__(self, name: str) -> Any:
        return self._values[name]

    def _check(self, parameters: list[Parameter]) -> SetParametersResult:
        for parameter in parameters:
            spec = self._specs.get(parameter.name)
            if spec is None:
                continue
            try:
                value = spec.checked(parameter.value)
            except ParameterError as reason:
                return SetParametersResult(successful=False, reason=str(reason))
            if not spec.live and value != self._values.get(spec.name):
                fixed = f'{spec.name}: {FIXED}'
                return SetParametersResult(successful=False, reason=fixed)
            with self._turns:
                objection = self._objection(spec.name, value)
            if objection:
                return SetParametersResult(successful=False, reason=objection)
        return SetParametersResult(successful=True)

    def _take(self, parameters: list[Parameter]) -> None:
        for parameter in parameters:
            spec = self._specs.get(parameter.name)
            if spec is not None:
                with self._turns:
                    self._values[spec.name] = spec.checked(parameter.value)
                    self._changed(spec.name)


def misspelt(node: Node) -> list[str]:
    """Return a sentence on each parameter given at the start that the node does not have.

    ROS leaves it unread, for one file of parameters may serve many nodes.
    """
    # rclpy has no public way to what was given and not declared.
    unread = [name for name in node._parameter_overrides if not node.has_parameter(name)]
    known = [name for name in node._parameters if not name.startswith(OWN_TO_ROS)]
    found = []
    for name in unread:
        if name not in OF_FRAMES and not name.startswith(OWN_TO_ROS):
            close = get_close_matches(name, known, n=1)
            meant = close[0] if close else f'one of {", ".join(sorted(known))}'
            found.append(f'parameter {name}: this node has none of that name; expected {meant}')
    return found


def _descriptor(sentence: str, live: bool) -> ParameterDescriptor:
    # Typed dynamically so that 2 is as good as 2.0; `checked` is stricter than ROS anyway. Not
    # read_only: ROS would refuse a change before it can be said what to do instead.
    return ParameterDescriptor(
        description=sentence, dynamic_typing=True, additional_constraints='' if live else FIXED
    )
