"""Plan of the blind tests: the trials and their numbers."""

from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from itertools import count, product

import numpy as np

from studies.harness import option
from trawl_ros.lab.trials.hidden_effects.inside import INSIDE
from trawl_ros.lab.trials.hidden_effects.other_keys import CAUSES
from trawl_ros.lab.trials.hidden_effects.outside import OUTSIDE
from trawl_ros.lab.trials.linearised_plant import MeshResolution
from trawl_ros.lab.trials.plant import FINER
from trawl_ros.lab.trials.tows import SEA
from trawl_ros.lab.trials.trial import Form, Spec

PLANTS = 8
STRENGTHS = (1.5, 3.0, 6.0)
OUTSIDE_STRENGTHS = (6.0, 10.0)
PAIR_STRENGTH = 3.0
DECK_STRENGTHS = (3.0, 6.0)
POOR_STRENGTH = 2.0
SEA_STRENGTHS = (3.0, 6.0)
CLEAN_AT_SEA = 4
"""One in so many trials of a day has nothing hidden."""

PAIRS = (
    ('current_shear', 'tension_cell'),
    ('catch_build_up', 'counter_offset'),
    ('warp_asymmetry', 'spread_sensor'),
    ('speed_log', 'depth_sensor'),
    ('net_drag', 'cross_current'),
    ('counter_scale', 'tension_cell'),
)

TRIPLES = (
    ('current_shear', 'tension_cell', 'spread_sensor'),
    ('net_drag', 'warp_asymmetry', 'depth_sensor'),
    ('catch_build_up', 'counter_offset', 'spread_sensor'),
    ('speed_log', 'gear_weight', 'depth_sensor'),
    ('heave', 'counter_scale', 'tension_cell'),
    ('bottom_contact', 'spread_sensor', 'tension_cell'),
)
"""Three at once, each as strong as effects of a pair."""

ALIKE_WHERE_POOR = (
    'counter_offset', 'counter_scale', 'cross_current', 'current_shear', 'depth_sensor',
    'gear_weight', 'speed_log', 'warp_asymmetry',
)  # fmt: skip
"""Each of these has a rival with a cosine above 0.9 in a poor trial."""

IN_BAGS = 20
"""One in so many trials is made as bags too."""


@dataclass(frozen=True)
class BlindStudyPlan:
    """Size of the study; rules were chosen by looking at trials of seeds 1, 31 to 35 and 51.

    Effects and causes are hidden to both sides in turn.
    """

    gear: str = option('kaifuha', 'Gear file or name.')
    seed: int = option(36, 'Of all trials.')
    clean: int = option(60, 'Trials with nothing hidden.')
    inside: int = option(2, 'Trials of each effect of the catalogue and strength.')
    outside: int = option(1, 'Trials of each effect outside the catalogue and strength.')
    pairs: int = option(2, 'Trials of each pair of effects.')
    poor: int = option(2, 'Trials of few states, of each effect that they cannot tell apart.')
    dynamic: int = option(23, 'Trials of a day at sea, in windows and towed in time.')
    deck: int = option(1, 'Trials of each cause on deck and strength.')
    triples: int = option(1, 'Trials of each three effects at once.')
    around: int = option(FINER.around, 'Meshes around the model net.')
    sample: int = option(0, 'So many of the trials of windows, drawn by chance; 0 for all.')

    @property
    def mesh(self) -> MeshResolution:
        """Mesh of model and plant."""
        return MeshResolution(**{**asdict(FINER), 'around': self.around})

    def specs(self) -> tuple[Spec, ...]:
        """All trials."""
        alone = tuple(self._in_windows())
        if self.sample:
            rng = np.random.default_rng([self.seed, *b'sample'])
            some = rng.permutation(len(alone))[: self.sample]
            return tuple(alone[place] for place in sorted(some))
        numbers = count(len(alone))
        full = [one for one in alone if one.plan == 'full']
        again = full[IN_BAGS // 2 :: IN_BAGS]

        def same(one: Spec, form: Form) -> Spec:
            return replace(one, number=next(numbers), form=form, like=one.number)

        bags = [same(one, 'bags') for one in again]
        at_sea = [replace(one, number=next(numbers)) for one in self._at_sea()]
        return (*alone, *bags, *at_sea, *(same(one, 'dynamic') for one in at_sea))

    def _at_sea(self) -> Iterator[Spec]:
        """Trials of a day: what is hidden is drawn from all that may be."""
        rng = np.random.default_rng([self.seed, *b'sea'])
        for number in range(self.dynamic):
            plan, plant = list(SEA)[number % len(SEA)], int(rng.integers(PLANTS))
            name = str(rng.choice([*INSIDE, *CAUSES]))
            strength = float(rng.choice(SEA_STRENGTHS))
            sign = float(rng.choice({**INSIDE, **CAUSES}[name](np.random.default_rng(0)).signs))
            # The plans take turns with what is hidden: each has trials without anything.
            if (number + number // len(SEA)) % CLEAN_AT_SEA == CLEAN_AT_SEA - 1:
                yield Spec('sea', number, (), 0.0, (), plant, plan)
            else:
                yield Spec('sea', number, (name,), strength, (sign,), plant, plan)

    def _in_windows(self) -> Iterator[Spec]:
        rng = np.random.default_rng([self.seed, *b'plan'])
        numbers = count()

        def spec(
            series: str,
            effects: tuple[str, ...],
            strength: float,
            signs: tuple[float, ...],
            plan: str = 'full',
        ) -> Spec:
            plant = int(rng.integers(PLANTS))
            return Spec(series, next(numbers), effects, strength, signs, plant, plan)

        for _ in range(self.clean):
            yield spec('clean', (), 0.0, ())
        for kind, group, strengths, many, plan in (
            ('inside', INSIDE, STRENGTHS, self.inside, 'full'),
            ('outside', OUTSIDE, OUTSIDE_STRENGTHS, self.outside, 'full'),
            ('poor', {name: INSIDE[name] for name in ALIKE_WHERE_POOR}, (POOR_STRENGTH,),
             self.poor, 'poor'),
        ):  # fmt: skip
            for name, strength in product(group, strengths):
                signs = group[name](np.random.default_rng(0)).signs
                first = int(rng.integers(len(signs)))
                for turn in range(many):
                    # To both sides in turn, whichever comes first.
                    side = signs[(first + turn) % len(signs)]
                    yield spec(kind, (name,), strength, (side,), plan)

        def sides_of(names: tuple[str, ...]) -> tuple[float, ...]:
            return tuple(
                float(rng.choice(INSIDE[name](np.random.default_rng(0)).signs)) for name in names
            )

        for names in PAIRS:
            for _ in range(self.pairs):
                yield spec('pair', names, PAIR_STRENGTH, sides_of(names))
        # Last, so that the draws of all others stay what they were.
        for name, strength in product(CAUSES, DECK_STRENGTHS):
            signs = CAUSES[name](np.random.default_rng(0)).signs
            first = int(rng.integers(len(signs)))
            for turn in range(self.deck):
                side = signs[(first + turn) % len(signs)]
                yield spec('deck', (name,), strength, (side,))
        for three in TRIPLES:
            for _ in range(self.triples):
                yield spec('triple', three, PAIR_STRENGTH, sides_of(three))
