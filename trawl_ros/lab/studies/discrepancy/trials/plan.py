"""Plan of the blind tests: the trials and their numbers."""

from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from itertools import count, product

import numpy as np

from trawl_ros.lab.studies.discrepancy.hidden_effects.inside import INSIDE
from trawl_ros.lab.studies.discrepancy.hidden_effects.other_keys import CAUSES
from trawl_ros.lab.studies.discrepancy.hidden_effects.outside import OUTSIDE
from trawl_ros.lab.studies.discrepancy.trials.tows import SEA
from trawl_ros.lab.studies.discrepancy.trials.trial import Form, Spec
from trawl_ros.lab.studies.identification.plant import Cut

SEED = 36
"""Of the study as it is reported; rules were chosen by looking at trials of 1, 31 to 35 and 51."""

FINER = Cut(around=12, lines=2, unjoined=True)
"""Plant and model."""

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
    """Plan of the study's size.

    Attributes
    ----------
    gear
        File or name.
    seed
        Of all trials.
    clean
        Trials without any effect.
    inside
        Trials of each effect of the catalogue and strength, to both sides in turn.
    outside
        Trials of each effect that is not in it and strength, likewise.
    pairs
        Trials of each of `PAIRS`.
    poor
        Trials, with a poor plan, of each of `ALIKE_WHERE_POOR`.
    dynamic
        Trials of a day at sea (`SEA`), one in four with nothing hidden, in windows and towed in
        time.
    deck
        Trials of each cause on deck and strength, to both sides in turn.
    triples
        Trials of each of `TRIPLES`.
    around
        Meshes around the mouth of the model's net.
    sample
        So many of the trials of windows alone, drawn by chance, and no bags; 0 for all of them.
    """

    gear: str = 'kaifuha'
    seed: int = SEED
    clean: int = 60
    inside: int = 2
    outside: int = 1
    pairs: int = 2
    poor: int = 2
    dynamic: int = 23
    deck: int = 1
    triples: int = 1
    around: int = FINER.around
    sample: int = 0

    @property
    def cut(self) -> Cut:
        """Mesh of model and plant."""
        return Cut(**{**asdict(FINER), 'around': self.around})

    def specs(self) -> tuple[Spec, ...]:
        """All trials."""
        alone = tuple(self._in_windows())
        if self.sample:
            chance = np.random.default_rng([self.seed, *b'sample'])
            some = chance.permutation(len(alone))[: self.sample]
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
        chance = np.random.default_rng([self.seed, *b'sea'])
        for number in range(self.dynamic):
            plan, plant = list(SEA)[number % len(SEA)], int(chance.integers(PLANTS))
            name = str(chance.choice([*INSIDE, *CAUSES]))
            strength = float(chance.choice(SEA_STRENGTHS))
            sign = float(chance.choice({**INSIDE, **CAUSES}[name](np.random.default_rng(0)).signs))
            # The plans take turns with what is hidden: each has trials without anything.
            if (number + number // len(SEA)) % CLEAN_AT_SEA == CLEAN_AT_SEA - 1:
                yield Spec('sea', number, (), 0.0, (), plant, plan)
            else:
                yield Spec('sea', number, (name,), strength, (sign,), plant, plan)

    def _in_windows(self) -> Iterator[Spec]:
        chance = np.random.default_rng([self.seed, *b'plan'])
        numbers = count()

        def spec(
            series: str,
            effects: tuple[str, ...],
            strength: float,
            signs: tuple[float, ...],
            plan: str = 'full',
        ) -> Spec:
            plant = int(chance.integers(PLANTS))
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
                first = int(chance.integers(len(signs)))
                for turn in range(many):
                    # To both sides in turn, whichever comes first.
                    side = signs[(first + turn) % len(signs)]
                    yield spec(kind, (name,), strength, (side,), plan)

        def sides_of(names: tuple[str, ...]) -> tuple[float, ...]:
            return tuple(
                float(chance.choice(INSIDE[name](np.random.default_rng(0)).signs)) for name in names
            )

        for names in PAIRS:
            for _ in range(self.pairs):
                yield spec('pair', names, PAIR_STRENGTH, sides_of(names))
        # Last, so that the draws of all others stay what they were.
        for name, strength in product(CAUSES, DECK_STRENGTHS):
            signs = CAUSES[name](np.random.default_rng(0)).signs
            first = int(chance.integers(len(signs)))
            for turn in range(self.deck):
                side = signs[(first + turn) % len(signs)]
                yield spec('deck', (name,), strength, (side,))
        for three in TRIPLES:
            for _ in range(self.triples):
                yield spec('triple', three, PAIR_STRENGTH, sides_of(three))
