# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Decision on the posterior: verdict, what is named, and what is not excluded."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from trawl_ros.diagnosis.inference.options import InferenceOptions
from trawl_ros.diagnosis.inference.posterior import Explanation, Posterior

Verdict = Literal['NO_DISCREPANCY', 'NAMED', 'AMBIGUOUS', 'UNKNOWN', 'NOT_TESTABLE']


@dataclass(frozen=True)
class NamedCause:
    """Leaf or node of the tree of causes that is named, and its probability.

    ``leaves`` are the names of its causes that are not excluded, the likeliest first.
    """

    path: str
    probability: float
    leaves: tuple[str, ...]

    @property
    def words(self) -> str:
        """Name of the cause, or of the node, in words."""
        return self.path.rpartition('/')[2].replace('_', ' ')

    @property
    def is_leaf(self) -> bool:
        """True for a single cause."""
        return self.path.endswith(f'/{self.leaves[0]}')


@dataclass(frozen=True)
class Decision:
    """Decision on the posterior.

    Attributes
    ----------
    verdict, reason
        And why.
    named
        Leaves and nodes that hold the cut, with the verdict NAMED.
    among
        Leaves that together hold the cut, the likeliest first.
    best
        Explanation that the repair, the sizes and the held-out comparison are of.
    """

    verdict: Verdict
    reason: str
    named: tuple[NamedCause, ...] = ()
    among: tuple[str, ...] = ()
    best: Explanation | None = None


def decide(posterior: Posterior, options: InferenceOptions, worse: Sequence[str] = ()) -> Decision:
    """Decide.

    Parameters
    ----------
    posterior
        The posterior.
    options
        The cut.
    worse
        Quantities that the best explanation makes worse on held-out tows.
    """
    cut = options.cut
    if 1.0 - posterior.nothing < cut:
        return Decision(
            'NO_DISCREPANCY',
            f'boards and errors explain all readings with a probability of {posterior.nothing:.2g}',
        )
    named = _named(posterior, cut)
    best = _explanation(posterior, named)
    among = _among(posterior, cut)
    if worse:
        listed = ' and '.join(name.replace('_', ' ') for name in worse)
        return Decision(
            'UNKNOWN', f'on held-out tows the likeliest cause makes {listed} worse', (), among, best
        )
    if posterior.unknown > 0.5:
        return Decision(
            'UNKNOWN',
            'something that the library does not have holds a probability of '
            f'{posterior.unknown:.2g}',
            (), among, best,
        )  # fmt: skip
    if named:
        listed = ' and '.join(f'{own.words} {own.probability:.3g}' for own in named)
        return Decision('NAMED', f'probability of {listed}', named, among, best)
    return Decision(
        'AMBIGUOUS',
        f'no cause and no place on deck holds a probability of {cut:g}',
        (),
        among,
        best,
    )


def _named(posterior: Posterior, cut: float) -> tuple[NamedCause, ...]:
    """Return the lowest nodes that hold the cut; none below another."""
    leaves = posterior.leaves
    found = []
    for name, probability in leaves.items():
        if probability >= cut:
            found.append(NamedCause(posterior.entry(name).entry.path, probability, (name,)))
    places = {posterior.entry(name).entry.node.path for name in leaves}
    for path, probability in posterior.nodes.items():
        if path not in places or probability < cut:
            continue
        if any(own.path.startswith(f'{path}/') for own in found):
            continue
        own = [name for name in leaves if posterior.entry(name).entry.node.path == path]
        kept = [name for name in own if leaves[name] >= (1.0 - cut) * probability]
        found.append(NamedCause(path, probability, tuple(kept or own[:1])))
    return tuple(found)


def _explanation(posterior: Posterior, named: Sequence[NamedCause]) -> Explanation | None:
    """Return the likeliest refitted explanation that has a leaf of all that is named."""
    refitted = [own for own in posterior.explanations if own.refit is not None]
    for own in refitted:
        if all(set(own.names) & set(cause.leaves) for cause in named):
            return own
    return refitted[0] if refitted else None


def _among(posterior: Posterior, cut: float) -> tuple[str, ...]:
    """Return the causes of the likeliest explanations that together hold the cut."""
    found: dict[str, None] = {}
    held, wanted = 0.0, cut * (1.0 - posterior.nothing - posterior.unknown)
    for own in posterior.explanations:
        if not own.suspects or own.unknown:
            continue
        if held >= wanted:
            break
        held += own.probability
        found |= dict.fromkeys(own.names)
    return tuple(found)
