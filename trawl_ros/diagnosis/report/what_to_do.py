"""Paragraph that says what to do now, after a diagnosis."""

from trawl_ros.diagnosis.diagnosis import Diagnosis
from trawl_ros.effects.base.effect import Effect
from trawl_ros.effects.catalogue.instruments import FROZEN_SENSOR as FROZEN
from trawl_ros.effects.registry import catalogue
from trawl_ros.gear.parts import own_parts

LOOKED_AT = 4
"""So many effects are looked at on deck, the likeliest first."""


def what_to_do(diagnosis: Diagnosis) -> str:
    """Advice on the next steps, in one paragraph."""
    return own_parts(' '.join(_sentences(diagnosis)), diagnosis.gear)


def _sentences(diagnosis: Diagnosis) -> list[str]:
    match diagnosis.verdict:
        case 'NO_DISCREPANCY':
            return ['Nothing need be done; the last table of the report says what would not show.']
        case 'NOT_TESTABLE':
            return ['Mend what the reason says, and diagnose again.']
    stuck = [_card(FROZEN)] if diagnosis.frozen else []
    if stuck and diagnosis.verdict == 'NAMED' and diagnosis.best is None:
        return [*stuck, 'Until it is mended its readings say nothing of the gear.']
    cards = [*stuck, *(_card(effect) for effect in _likely(diagnosis))]
    changes = [
        f'{str(mimic)[0].upper()}{str(mimic)[1:]}: {mimic.change.direct}'
        for mimic in diagnosis.mimics
    ]
    # Without a name a change is told where it explains more than the best effect.
    cards = [*changes, *cards] if diagnosis.verdict == 'UNKNOWN' else [*cards, *changes]
    looked_at = [f'{number}. {card}' for number, card in enumerate(cards, 1)]
    if diagnosis.verdict == 'NAMED':
        first = 'Look first at what is named.' if looked_at else ''
        mended = 'If it is found and mended, tow the same states again beside the same baseline; '
        go_on = (
            'go on with the repaired gear file, with which the same bags should show nothing more.'
        )
        last = f'{mended}else {go_on}' if looked_at else go_on.capitalize()
    elif diagnosis.verdict == 'AMBIGUOUS':
        first = 'Look at these, the likeliest first.' if looked_at else ''
        last = (
            f'What no look tells, a tow does: {diagnosis.proposals[0]}'
            if diagnosis.proposals
            else 'Tows of other warp lengths and speeds make the evidence stronger.'
        )
    else:
        channels = list(dict.fromkeys(where.channel for where in diagnosis.where))[:3]
        first = (
            f'Check the instruments of {", ".join(channels).replace("_", " ")}, and rigging and '
            'net against the gear file.'
            if channels
            else 'Check rigging and net against the gear file.'
        )
        last = 'Do not change the gear file for an effect that is not named.'
    return [part for part in (first, *looked_at, last) if part]


def _likely(diagnosis: Diagnosis) -> list[Effect]:
    """Effects of the catalogue that are named or not excluded, the likeliest first."""
    best, named = diagnosis.best, diagnosis.named
    if best is None or named is None:
        return []
    others = () if diagnosis.verdict == 'UNKNOWN' else (*named.alike, *named.rivals)
    names = dict.fromkeys((*best.refit.names, *others))
    effects = [catalogue()[name] for name in names if name in catalogue()]
    return [effect for effect in effects if effect.direct or effect.causes][:LOOKED_AT]


def _card(effect: Effect) -> str:
    """Card of an effect: its causes, and how to check it."""
    looks = f': {effect.causes}' if effect.causes else '.'
    check = f' {effect.direct}' if effect.direct else ''
    return f'{effect.name.replace("_", " ").capitalize()}{looks}{check}'
