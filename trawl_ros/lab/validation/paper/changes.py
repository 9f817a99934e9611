# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Changes of observables by rotated boards, in percent and degrees."""

import math
from collections.abc import Callable, Mapping

import numpy as np

from trawl_ros.lab.validation.paper.installation import SYMBOLS
from trawl_ros.lab.validation.paper.sweeps import INSTALLATION, TURN, Sighting


def percent_change(after: Sighting, before: Sighting, quantity: str) -> float:
    """Relative change of an observable, %."""
    change: float = 100.0 * (getattr(after.seen, quantity) / getattr(before.seen, quantity) - 1.0)
    return change


def board_percent(after: Sighting, before: Sighting, quantity: str) -> float:
    """Relative change of a quantity of the port board, %; NaN where it was zero."""
    base = getattr(before.board, quantity)
    change: float = 100.0 * (getattr(after.board, quantity) / base - 1.0) if base else math.nan
    return change


class Changes:
    """Changes from the gear as it is by turns of ±5°, each named by its angle and its degrees.

    Parameters
    ----------
    found
        Angle → turn → the gear, from `installation_sweep`.
    faster
        The gear as it is at another speed, which tells apart what pull and spread do.
    """

    def __init__(self, found: Mapping[str, Mapping[float, Sighting]], faster: Sighting) -> None:
        self.found, self.faster = found, faster
        self.base = found['epsilon'][0.0]
        self.turned = [(name, turn) for name in INSTALLATION for turn in (TURN, -TURN)]

    def percent(self, quantity: str, name: str, turn: float) -> float:
        """Change of an observable, %."""
        return percent_change(self.found[name][turn], self.base, quantity)

    def board(self, quantity: str, name: str, turn: float) -> float:
        """Change of a quantity of the port board, %."""
        return board_percent(self.found[name][turn], self.base, quantity)

    def degrees(self, angle: str, name: str, turn: float) -> float:
        """Change of an angle of the port board, °."""
        before = getattr(self.base.seen, f'port_{angle}')
        after = getattr(self.found[name][turn].seen, f'port_{angle}')
        return float(np.degrees(after - before))

    def largest(self, quantities: tuple[str, ...], *names: str) -> float:
        """Largest change of several observables by several angles, %."""
        return max(
            abs(self.percent(quantity, name, turn))
            for quantity in quantities
            for name in names
            for turn in (TURN, -TURN)
        )

    def most_degrees(self, name: str) -> float:
        """Largest change of α and δ by one angle, °."""
        return max(
            abs(self.degrees(angle, name, turn))
            for angle in ('attack', 'inclination')
            for turn in (TURN, -TURN)
        )

    def against(self, agree: Callable[[str, float], bool], *quantities: str) -> tuple[float, str]:
        """Number of the six rotations that agree, and a sentence on the others."""
        odd = [turn for turn in self.turned if not agree(*turn)]
        sentence = '; '.join(
            f'{label(*turn)}: '
            + ', '.join(
                f'{q.replace("_", " ")} {self.percent(q, *turn):+.2f} %' for q in quantities
            )
            for turn in odd
        )
        return float(len(self.turned) - len(odd)), sentence


def label(name: str, turn: float) -> str:
    """Label of a turn in symbols."""
    return f'{SYMBOLS[name]} {turn:+g}°'
