"""Plan of the blind trials: what is hidden in each, and how strong."""

from dataclasses import dataclass

import numpy as np

from studies.harness import option
from trawl_ros.lab.trials.answers import NOT_IN_LIBRARY
from trawl_ros.lab.trials.hidden_effects.inside import INSIDE
from trawl_ros.lab.trials.hidden_effects.other_keys import CAUSES
from trawl_ros.lab.trials.hidden_effects.outside import OUTSIDE
from trawl_ros.lab.trials.plant import FINER
from trawl_ros.lab.trials.trial import Spec

TRIALS_OF_A_PLANT = 40
"""A plant takes long to make."""

STRENGTHS = (3.0, 6.0)
SERIES = ('clean', 'alone', 'outside', 'pair')
SHARES = (0.2, 0.6, 0.1, 0.1)
"""Series of trials, and their share."""

PAIRS = (
    ('rigging_epsilon', 'speed_log'),
    ('tension_cell', 'floats_gone'),
    ('counter_offset', 'net_drag'),
    ('clumps', 'spread_sensor'),
)
"""Two causes at once, each as strong as if alone."""

ALONE = sorted({*INSIDE, *CAUSES, *OUTSIDE} - set(NOT_IN_LIBRARY))


@dataclass(frozen=True)
class BlindStudyPlan:
    """Size of the study; options of the inference were fitted on trials of seeds 101 to 103."""

    gear: str = option('kaifuha', 'Gear file or name.')
    seed: int = option(201, 'Of all trials.')
    trials: int = option(300, 'Number of trials.')

    def asked(self) -> dict[str, object]:
        """Return the settings of each trial."""
        return {'gear': self.gear, 'seed': self.seed, 'around': FINER.around}

    def spec(self, number: int) -> Spec:
        """Return what a trial is; another draw where that cannot be towed has another number."""
        rng = np.random.default_rng([self.seed, number, *b'spec'])
        series = str(rng.choice(SERIES, p=SHARES))
        plant = number // TRIALS_OF_A_PLANT
        if series == 'clean':
            return Spec(series, number, (), 0.0, (), plant, 'day')
        drawn: dict[str, list[tuple[str, ...]]] = {
            'alone': [(name,) for name in ALONE],
            'pair': list(PAIRS),
            'outside': [(name,) for name in NOT_IN_LIBRARY],
        }
        effects = drawn[series][int(rng.integers(len(drawn[series])))]
        strength = 6.0 if series == 'outside' else float(rng.choice(STRENGTHS))
        every = {**INSIDE, **OUTSIDE, **CAUSES}
        signs = tuple(
            float(rng.choice(every[name](np.random.default_rng(0)).signs)) for name in effects
        )
        return Spec(series, number, effects, strength, signs, plant, 'day')
