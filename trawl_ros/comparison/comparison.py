# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Comparison: the record that reports are made of."""

import shlex
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from trawl_ros.comparison.summary import ComparedSensor, ComparedState
from trawl_ros.comparison.verdict import Verdict
from trawl_ros.core.arrays import FloatArray


@dataclass(frozen=True)
class ComparedCourse:
    """Course of one log in minutes, SI.

    Attributes
    ----------
    hours : (n,) array
        Time from the start of the log, h.
    measured, reference
        Channel → values (n,), NaN where there are none.
    """

    hours: FloatArray
    measured: Mapping[str, FloatArray]
    reference: Mapping[str, FloatArray]


@dataclass(frozen=True)
class Comparison:
    """Comparison of logs with a gear file as it is, or of two logs.

    Attributes
    ----------
    sensors, states
        Each sensor over all states, and each state with its sensors.
    courses
        Course of each log.
    verdict
        Verdict and next step.
    kind
        ``gear`` or ``bags``.
    logs, gear
        Paths of the logs, and the gear as it was named.
    names
        What is compared, for headings: measured, and predicted or the second log.
    notes
        Sentences on what was left out.
    """

    sensors: tuple[ComparedSensor, ...]
    states: tuple[ComparedState, ...]
    courses: tuple[ComparedCourse, ...]
    verdict: Verdict
    kind: str = 'gear'
    logs: tuple[str, ...] = ()
    gear: str = ''
    names: tuple[str, str] = ('measured', 'predicted')
    notes: tuple[str, ...] = ()

    @property
    def title(self) -> str:
        """Heading: the logs and what they are compared with."""
        if self.kind == 'bags':
            return ' and '.join(self.names)
        return f'{", ".join(Path(log).name for log in self.logs)} and {Path(self.gear).name}'

    @property
    def next_step(self) -> str:
        """Next step in a sentence."""
        return self.verdict.next_step(shlex.join(self.logs), shlex.quote(self.gear))
