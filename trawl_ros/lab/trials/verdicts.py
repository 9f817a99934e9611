"""Verdicts on a blind case against its hidden effects.

Only the key and ``diagnosis.json`` of a case are used here.
"""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from trawl_ros.diagnosis.candidates import values_vector
from trawl_ros.diagnosis.rules import ALIKE
from trawl_ros.effects.registry import catalogue
from trawl_ros.lab.trials.hidden_effects.other_keys import RIGHT_CHANGES, RIGHT_NAMES
from trawl_ros.lab.trials.strength import Likelihood
from trawl_ros.lab.trials.trial import Scored

MOST_OF_THREE = 2
"""Number of effects to find out of three at once."""

Classes = Mapping[str, tuple[str, ...]]
"""Names accepted for each effect, fixed before any case is made."""


def names_of(trial: Scored) -> set[str]:
    """Named effects."""
    return {effect['name'] for effect in said_of(trial)['effects']}


def reported(trial: Scored) -> set[str]:
    """Return all effects, and changes of the gear file, that are not excluded."""
    alike = {name for effect in said_of(trial)['effects'] for name in effect['class']}
    return names_of(trial) | alike | set(said_of(trial)['ambiguous_with']) | _changes(trial)


def _changes(trial: Scored) -> set[str]:
    """Changes of the gear file that are not excluded beside an effect."""
    found = said_of(trial)
    listed = found.get('mimics', ()) if found['verdict'] == 'AMBIGUOUS' else ()
    return {change['name'] for change in listed}


def hidden_names(trial: Scored) -> tuple[str, ...]:
    """Hidden effects."""
    return tuple(trial.key['spec']['effects'])


def chosen(trials: Iterable[Scored], series: str, strength: float | None = None) -> list[Scored]:
    """Testable trials of a series and a strength."""
    return [
        trial
        for trial in trials
        if trial.key['spec']['series'] == series
        and trial.key['spec']['form'] == 'windows'
        and trial.diagnosis is not None
        and (strength is None or trial.key['spec']['strength'] == strength)
    ]


def verdict_word(trial: Scored) -> str:
    """The first word of a diagnosis."""
    return str(said_of(trial)['verdict'])


def right(trial: Scored, names: set[str], classes: Classes) -> bool:
    """True if every hidden effect is named, by its own name or that of its class."""
    return all(names & right_names(name, classes) for name in hidden_names(trial))


def right_names(hidden: str, classes: Classes) -> set[str]:
    """Names that count as right for a hidden effect.

    These are its own name or that of its cause, all of the same class, and the changes of the gear
    file that are the cause.
    """
    own = RIGHT_NAMES.get(hidden, (hidden,))
    alike = (other for name in own for other in classes.get(name, ()))
    return {*own, *alike, *RIGHT_CHANGES.get(hidden, ())}


def named_right(trial: Scored, classes: Classes) -> bool:
    """True if exactly one effect is named, and it is right."""
    alone = len(said_of(trial)['effects']) == 1
    return verdict_word(trial) == 'NAMED' and alone and right(trial, names_of(trial), classes)


def both_named(trial: Scored, classes: Classes) -> bool:
    """True if two effects are hidden and both are named."""
    pair = trial.key['spec']['series'] == 'pair'
    return pair and verdict_word(trial) == 'NAMED' and right(trial, names_of(trial), classes)


def one_named(trial: Scored, classes: Classes) -> bool:
    """True if one of two hidden effects is named, and no absent one."""
    names = names_of(trial)
    pair = trial.key['spec']['series'] == 'pair' and not both_named(trial, classes)
    return (
        pair
        and verdict_word(trial) == 'NAMED'
        and bool(names)
        and names <= set(hidden_names(trial))
    )


def found_of_three(trial: Scored, classes: Classes) -> bool:
    """True if at least two of three hidden effects are named, and no absent one."""
    names = names_of(trial)
    hidden = hidden_names(trial)
    found = [name for name in hidden if names & right_names(name, classes)]
    there = {own for name in hidden for own in right_names(name, classes)}
    return verdict_word(trial) == 'NAMED' and len(found) >= MOST_OF_THREE and names <= there


def wrong_named(trial: Scored, classes: Classes) -> bool:
    """True if an absent effect is named."""
    there = {own for name in hidden_names(trial) for own in right_names(name, classes)}
    return verdict_word(trial) == 'NAMED' and not names_of(trial) <= there


def set_size(trial: Scored, classes: Classes) -> int:
    """Number of classes that are not excluded, and of changes of the gear file."""
    own = {name for one in names_of(trial) for name in classes.get(one, (one,))}
    return 1 + len(reported(trial) - own)


def said_of(trial: Scored) -> dict[str, Any]:
    """Diagnosis of the trial."""
    assert trial.diagnosis is not None
    return trial.diagnosis


def same_said(trial: Scored, other: Scored) -> bool:
    """True if verdict and names are the same."""
    return verdict_word(trial) == verdict_word(other) and names_of(trial) == names_of(other)


def parted(trial: Scored) -> bool:
    """True if only the right effect is left."""
    return verdict_word(trial) == 'NAMED' and reported(trial) == set(hidden_names(trial))


def checked(trial: Scored, classes: Classes) -> bool:
    """True if the right effect is left, and all those left but one have a check without a tow."""
    left = reported(trial) & set(catalogue())
    unchecked = [name for name in left if not catalogue()[name].direct]
    return right(trial, left, classes) and len(unchecked) <= 1


def classes(likely: Likelihood) -> Mapping[str, tuple[str, ...]]:
    """Return for each effect all effects that any of its parameters can imitate.

    This is to first order, by cosines above `ALIKE` for the plan of the case.
    """
    found = likely.mimicry
    blocks = list(zip(likely.wanted, values_vector(likely.wanted).blocks('effect'), strict=True))
    alike: dict[str, set[str]] = {one.name: {one.name} for one, _ in blocks}
    for one, block in blocks:
        for row in np.eye(len(block)):
            alike[one.name] |= {
                other.name
                for other, rows in blocks
                if other.name != one.name and found.covered(block, row, rows) > ALIKE
            }
    return {name: tuple(sorted(names)) for name, names in alike.items()}
