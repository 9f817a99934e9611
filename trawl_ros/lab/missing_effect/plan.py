# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Plan of the blind trials: what is hidden in each, and how strong."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.lab.trials.answers import EVERY_CAUSE, NOT_IN_LIBRARY
from trawl_ros.lab.trials.trial import Form, Series, Spec

IN_LIBRARY = sorted(set(EVERY_CAUSE) - set(NOT_IN_LIBRARY))
"""Hidden causes that a hypothesis of the library is."""

PAIRS = (
    ('rigging_epsilon', 'speed_log'),
    ('tension_cell', 'kite_gone'),
    ('counter_offset', 'net_drag'),
    ('clumps', 'spread_sensor'),
)
"""Two causes at once, each as strong as if alone."""

SERIES_SHARES: dict[Series, float] = {'clean': 0.2, 'alone': 0.6, 'outside': 0.1, 'pair': 0.1}
"""Share of the trials of each series."""


@dataclass(frozen=True)
class DrawOptions:
    """Options of the draw of trials.

    Attributes
    ----------
    trials_of_a_plant
        Number of consecutive trials that share a plant, which takes long to make.
    strengths
        Strengths of a cause of the library, in smallest detectable sizes.
    outside_strength
        Strength of a cause outside the library.
    plan
        Name of the plan of the tows, one of `trawl_ros.lab.trials.tows.PLANS`.
    """

    trials_of_a_plant: int = 40
    strengths: tuple[float, ...] = (3.0, 6.0)
    outside_strength: float = 6.0
    plan: str = 'day'


def drawn_spec(
    seed: int, number: int, form: Form = 'windows', options: DrawOptions | None = None
) -> Spec:
    """Draw the specification of a trial; it depends on the seed and its number alone."""
    options = options or DrawOptions()
    rng = np.random.default_rng([seed, number, *b'spec'])
    names = list(SERIES_SHARES)
    series = names[int(rng.choice(len(names), p=list(SERIES_SHARES.values())))]
    plant = number // options.trials_of_a_plant
    if series == 'clean':
        return Spec(series, number, (), 0.0, (), plant, options.plan, form)
    drawn: dict[Series, list[tuple[str, ...]]] = {
        'alone': [(name,) for name in IN_LIBRARY],
        'pair': list(PAIRS),
        'outside': [(name,) for name in NOT_IN_LIBRARY],
    }
    effects = drawn[series][int(rng.integers(len(drawn[series])))]
    outside = series == 'outside'
    strength = options.outside_strength if outside else float(rng.choice(options.strengths))
    signs = tuple(
        float(rng.choice(EVERY_CAUSE[name](np.random.default_rng(0)).signs)) for name in effects
    )
    return Spec(series, number, effects, strength, signs, plant, options.plan, form)
