"""Two or three effects at once: the sets that explain most to first order, refitted."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from trawl_ros.core.progress import OnProgress
from trawl_ros.diagnosis.candidates import Candidate
from trawl_ros.diagnosis.refit import Refit, refitted, refitted_without, told
from trawl_ros.diagnosis.rules import LEAST_BIC, NEARLY_ALIKE, RIVAL, SCREEN
from trawl_ros.diagnosis.score_test import ScoreTest
from trawl_ros.diagnosis.weighing import (
    LeftOver,
    Weighed,
    left_over,
    penalised_together,
    possible_first,
    rivals_of_best,
    to_be_there,
    twins,
    weigh,
)
from trawl_ros.solver.predict import Predictor

PAIR, THREE = 2, 3
"""Effects at once; more than three are not looked for."""

SECONDS = 2
"""So many are tried beside the best where there are effects like it."""

EXTENDED = 25
"""So many sets of each number are extended by every other effect."""

Set = tuple[Candidate, ...]


def likeliest_sets(test: ScoreTest, number: int) -> tuple[Set, ...]:
    """Sets of so many effects that explain most to first order, the likeliest first.

    The first effect alone may be what two that are there look like together: the best of three need
    not have the best of two in it.
    """
    sets: list[Set] = sorted(
        ((candidate,) for candidate in test.wanted), key=lambda own: -penalised_together(test, own)
    )
    for _ in range(1, number):
        grown = {
            frozenset(map(id, (*own, more))): (*own, more)
            for own in sets[:EXTENDED]
            for more in test.wanted
            if more.name not in [candidate.name for candidate in own]
        }
        sets = sorted(grown.values(), key=lambda own: -penalised_together(test, own))
    return tuple(sets)


def _like_the_best(test: ScoreTest, weighed: Sequence[Weighed]) -> Set:
    """Candidates for a second effect that to first order look like the best, or much like it: some
    of its rivals, and other errors of its instrument.

    Residuals of the best in their direction are seen badly to first order.
    """
    best = weighed[0]
    (first,) = best.refit.wanted
    rest = test.evidence.without(test.block(first))
    others = [candidate for candidate in test.wanted if candidate.name != first.name]
    others.sort(key=lambda candidate: test.penalised(candidate, rest), reverse=True)
    near, own = _near(test, weighed), _of_one_instrument(test, best)
    chosen = _once(candidate for candidate in others if candidate.name in near)[:SECONDS]
    return _once([*chosen, *(candidate for candidate in others if candidate.name in own)])


def _once(wanted: Iterable[Candidate]) -> Set:
    """First candidate of each effect."""
    first: dict[str, Candidate] = {}
    for candidate in wanted:
        first.setdefault(candidate.name, candidate)
    return tuple(first.values())


def _near(test: ScoreTest, weighed: Sequence[Weighed]) -> frozenset[str]:
    """Names of effects nearly as good as the best, or nearly the same: both may be present."""
    refitted_too = {name for other in weighed[1:] for name in other.refit.names}
    alike = refitted_too.intersection(twins(test, weighed[0].refit, NEARLY_ALIKE))
    return frozenset({*rivals_of_best(test, weighed), *alike})


def _of_one_instrument(test: ScoreTest, best: Weighed) -> frozenset[str]:
    """Other errors of the instrument whose error is the best: one seldom comes without them."""
    (first,) = best.refit.wanted
    own = first.effect.instrument
    return frozenset(
        candidate.name for candidate in test.wanted if own and candidate.effect.instrument == own
    ) - {first.name}


@dataclass
class SetsTried:
    """Sets tried so far: the refits of a diagnosis, each made once.

    Attributes
    ----------
    predictor, base, test
        The gear as it is believed, the boards alone, and the score test.
    refits
        Those that have all steady states.
    """

    predictor: Predictor
    base: Refit
    test: ScoreTest
    refits: list[Refit]
    on_progress: OnProgress
    _known: set[frozenset[str]] = field(init=False)

    def __post_init__(self) -> None:
        self._known = {frozenset(own.names) for own in self.refits}

    def add(self, wanted: Set) -> None:
        """Refit a set that was not tried yet."""
        names = [candidate.name for candidate in wanted]
        if frozenset(names) in self._known:
            return
        self._known.add(frozenset(names))
        self.on_progress(told(*names))
        fitted = refitted(self.predictor, self.base, self.test, wanted)
        # A set with a part of what is there as a whole is another in disguise.
        if fitted is not None and not (len(wanted) > 1 and fitted.in_part()):
            self.refits.append(fitted)

    def add_without(self, larger: Refit) -> None:
        """Refit each set that lacks one effect of a larger one, from where that rests.

        What was refitted already is kept where it is the likelier.
        """
        for left_out in larger.wanted:
            rest = tuple(own for own in larger.wanted if own is not left_out)
            names = {candidate.name for candidate in rest}
            self.on_progress(told(*(candidate.name for candidate in rest)))
            again = refitted_without(self.predictor, self.base, larger, left_out)
            self._known.add(frozenset(names))
            if again is None or (len(rest) > 1 and again.in_part()):
                continue
            same = [again, *(own for own in self.refits if set(own.names) == names)]
            self.refits = [own for own in self.refits if set(own.names) != names]
            self.refits.append(min(same, key=lambda own: own.fit.negative_log_likelihood))

    def add_class_of(self, best: Weighed) -> None:
        """Refit each effect that to first order is not told from the best."""
        alike = twins(self.test, best.refit)
        ranked = sorted(self.test.wanted, key=self.test.penalised, reverse=True)
        for candidate in _once(own for own in ranked if own.name in alike):
            self.add((candidate,))

    def weighed(self) -> tuple[Weighed, ...]:
        """All of them at one noise, the best first."""
        return possible_first(weigh(self.base, self.test, self.refits))

    def left_by(self, weighed: Weighed) -> LeftOver:
        """Residuals beyond their errors."""
        return left_over(self.base, self.test, weighed.refit)


def several_at_once(
    tried: SetsTried, weighed: tuple[Weighed, ...], left: LeftOver
) -> tuple[tuple[Weighed, ...], LeftOver]:
    """Weigh sets of two and three effects beside those alone, where there may be several; with the
    residuals of what then stands first.

    Parameters
    ----------
    tried
        With the effects alone.
    weighed, left
        These, the best first, and what it leaves over.
    """
    (first,) = weighed[0].refit.wanted
    for second in _like_the_best(tried.test, weighed):
        tried.add((second,))
        tried.add((first, second))
    _try_larger(tried, weighed[0], left)
    if not _explains_more(tried, PAIR):
        alone = _of_number(tried.weighed(), 1)
        return alone, tried.left_by(alone[0])
    pair = _of_number(tried.weighed(), PAIR)
    _try_larger(tried, pair[0], tried.left_by(pair[0]))
    for number in (PAIR, THREE):
        _try_exchanged(tried, number)
    of_three = _explains_more(tried, THREE)
    of_two = _explains_more(tried, PAIR)
    alone, pair, three = (_of_number(tried.weighed(), number) for number in (1, PAIR, THREE))
    if of_three:
        with_three = tried.left_by(three[0])
        if not with_three.too_much:
            return (*_near_best(three), *alone), with_three
    left = tried.left_by(pair[0])
    if of_two and not left.too_much:
        return (*_near_best(pair), *alone), left
    return alone, tried.left_by(alone[0])


def _explains_more(tried: SetsTried, number: int) -> bool:
    """True if the best set of a number explains enough more than the best of fewer effects, also
    once those that lack one of its own are refitted from where it rests.
    """

    def more() -> Weighed | None:
        weighed = tried.weighed()
        smaller = next(own for own in weighed if len(own.refit.wanted) < number)
        for larger in _of_number(weighed, number)[:1]:
            if larger.delta_bic > smaller.delta_bic + _more(tried.test, smaller, larger):
                return larger
        return None

    if (larger := more()) is None:
        return False
    tried.add_without(larger.refit)
    return more() is not None


def _try_larger(tried: SetsTried, best: Weighed, left: LeftOver) -> None:
    """Refit the likeliest set of one effect more, and the likeliest with the best among them, where
    to first order they explain much more; the second too where the best leaves too much over.
    """
    test, own = tried.test, best.refit.wanted
    larger = [(*own, more) for more in test.wanted if more.name not in best.refit.names]
    if not larger:
        return
    beside = max(larger, key=lambda wanted: penalised_together(test, wanted))
    for wanted in (likeliest_sets(test, len(own) + 1)[0], beside):
        more = penalised_together(test, wanted) - penalised_together(test, own)
        nested = set(best.refit.names) <= {candidate.name for candidate in wanted}
        if more > _enough(best, nested=nested) or (nested and left.too_much):
            tried.add(wanted)


def _try_exchanged(tried: SetsTried, number: int) -> None:
    """Refit the likeliest of the sets that have another effect in the place of one of the best set
    of a number: what it explains beside the rest another may explain as well.
    """
    best = _of_number(tried.weighed(), number)[:1]
    if not best:
        return
    test, own = tried.test, best[0].refit.wanted
    sets = {
        frozenset(candidate.name for candidate in wanted): wanted
        for wanted in sorted(
            (
                (*(kept for kept in own if kept is not out), other)
                for out in own
                for other in test.wanted
                if other.name not in best[0].refit.names
            ),
            key=lambda wanted: penalised_together(test, wanted),
        )
    }
    least = penalised_together(test, own) - SCREEN
    near = [wanted for wanted in sets.values() if penalised_together(test, wanted) > least]
    for wanted in near[: -SECONDS - 1 : -1]:
        tried.add(wanted)


def _enough(best: Weighed, *, nested: bool) -> float:
    """Criterion by which a set of one effect more must exceed the best.

    More is asked where a third joins two, which may be their own other form, and of any two, which
    may be that of one.
    """
    return LEAST_BIC if not nested and len(best.refit.wanted) >= PAIR else to_be_there(best)


def _more(test: ScoreTest, best: Weighed, larger: Weighed) -> float:
    """Criterion by which a larger set must exceed the best, refitted: less where to first order its
    second is not told from the first.
    """
    added = set(larger.refit.names) - set(best.refit.names)
    if len(best.refit.wanted) == 1 and len(added) == 1:
        alike = {*twins(test, best.refit, NEARLY_ALIKE), *_of_one_instrument(test, best)}
        if added <= alike:
            return LEAST_BIC
    return _enough(best, nested=len(added) == 1)


def _of_number(weighed: Sequence[Weighed], number: int) -> tuple[Weighed, ...]:
    """Those that are so many effects at once, the best first."""
    return tuple(entry for entry in weighed if len(entry.refit.wanted) == number)


def _near_best(weighed: Sequence[Weighed]) -> tuple[Weighed, ...]:
    """The first, and those that it does not exclude."""
    return tuple(own for own in weighed if weighed[0].delta_bic - own.delta_bic < RIVAL)
