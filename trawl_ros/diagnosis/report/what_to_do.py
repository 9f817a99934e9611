# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Paragraph that says what to do now, after a diagnosis."""

from trawl_ros.diagnosis.diagnosis import Diagnosis
from trawl_ros.diagnosis.library.entries import Entry
from trawl_ros.effects.base.effect import Effect
from trawl_ros.effects.catalogue.instruments import FROZEN_SENSOR as FROZEN
from trawl_ros.gear.parts import own_parts

LOOKED_AT = 4
"""Largest number of causes that are looked at on deck, the likeliest first."""


def what_to_do(diagnosis: Diagnosis) -> str:
    """Return advice on the next steps, in one paragraph."""
    return own_parts(' '.join(_sentences(diagnosis)), diagnosis.gear)


def _sentences(diagnosis: Diagnosis) -> list[str]:
    match diagnosis.verdict:
        case 'NO_DISCREPANCY':
            return ['No action is needed. The statistics of the report say what would not show.']
        case 'NOT_TESTABLE':
            return ['Correct what the reason says, and diagnose again.']
    stuck = [_frozen(FROZEN)] if diagnosis.frozen else []
    if stuck and diagnosis.verdict == 'NAMED' and diagnosis.best is None:
        return [*stuck, 'Until it is repaired its readings say nothing of the gear.']
    cards = [*stuck, *(_card(entry) for entry in _likely(diagnosis))]
    looked_at = [f'{number}. {card}' for number, card in enumerate(cards, 1)]
    if diagnosis.verdict == 'NAMED':
        first = 'Look first at what is named.'
        last = (
            'If you find and repair it, tow the same states again with the same baseline. If not, '
            'use the repaired gear file: with it the same bags should show nothing more.'
        )
    elif diagnosis.verdict == 'AMBIGUOUS':
        first = 'Look at these, the likeliest first.'
        last = (
            f'If inspection does not decide, tow this: {diagnosis.proposals[0]}'
            if diagnosis.proposals
            else 'Tows of other warp lengths and speeds make the evidence stronger.'
        )
    else:
        channels = list(dict.fromkeys(where.channel for where in diagnosis.where))[:3]
        listed = ', '.join(channels).replace('_', ' ')
        first = f'Check the instruments of {listed}, and rigging and net against the gear file.'
        last = 'Do not change the gear file for a cause that is not named.'
    return [first, *looked_at, last]


def _likely(diagnosis: Diagnosis) -> list[Entry]:
    """Return causes that are named or not excluded, with a check each, the likeliest first."""
    posterior = diagnosis.posterior
    if posterior is None or diagnosis.verdict == 'UNKNOWN':
        return []
    names = [name for cause in diagnosis.named for name in cause.leaves] or list(diagnosis.among)
    entries: dict[str, Entry] = {}
    first = diagnosis.best.names if diagnosis.best else ()
    for name in sorted(names, key=lambda name: (name not in first, -posterior.leaves[name])):
        entry = posterior.entry(name).entry
        entries.setdefault(entry.check, entry)
    return list(entries.values())[:LOOKED_AT]


def _card(entry: Entry) -> str:
    """Return the card of a cause: what it may be on deck, and how to check it."""
    causes = entry.effect.causes
    looks = f': {causes}' if causes else '.'
    return f'{entry.name.replace("_", " ").capitalize()}{looks} {entry.check}'


def _frozen(effect: Effect) -> str:
    name = effect.name.replace('_', ' ').capitalize()
    return f'{name}: {effect.causes} {effect.direct}'
