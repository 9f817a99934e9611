# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Claims of section IV.C on the gear with turned boards, Fig. 7 to 10."""

import numpy as np

from trawl_ros.lab.report.measured import MeasuredValue, at_least, at_most, between
from trawl_ros.lab.validation.paper.changes import Changes, label, percent_change
from trawl_ros.lab.validation.paper.claim import Claim, claim
from trawl_ros.lab.validation.paper.sweeps import TURN

SPAN = (5.0, 10.0)
"""The paper's 5 to 10 %."""

SMALL_EFFECT_SHARE = 0.5
"""Share of the largest effect below which an effect counts as small."""

RESULTS = ('door_spread', 'door_depth', 'vertical_opening', 'warp_tension')


def installation_claims(changes: Changes) -> list[Claim]:
    """Return all claims on spread, opening and tension."""
    return [_zeta(changes), _spread(changes), _opening(changes), *_signs(changes)]


def _zeta(changes: Changes) -> Claim:
    most = max(RESULTS, key=lambda quantity: changes.largest((quantity,), 'zeta'))
    slip = changes.degrees('slip', 'zeta', TURN)
    against = changes.most_degrees('zeta') / changes.most_degrees('epsilon')
    return claim(
        'IV.C, Fig. 7-12',
        'ζ has little effect on the results',
        MeasuredValue(
            'most that ±5° of ζ move spread, depth, opening and tension',
            changes.largest(RESULTS, 'zeta'),
            '%',
            at_most(SPAN[0]),
            f'most moved is the {most.replace("_", " ")}; the slip angle changes by '
            f'{slip:+.1f}° with ζ +5°, and with it C_z^F and C_y^M.',
            key='zeta_gear',
        ),
        MeasuredValue(
            'most that ζ moves α and δ over most that ε does',
            against,
            target=at_most(SMALL_EFFECT_SHARE),
            note='δ of eq. 38 is the tilt in any direction; turning about y tilts fore and aft.',
            key='zeta_angles',
        ),
    )


def _spread(changes: Changes) -> Claim:
    checks = []
    for name, turn in changes.turned:
        if name == 'zeta':  # the sentence before has set it aside
            continue
        reason = (
            f'{label(name, turn)} changes α by {changes.degrees("attack", name, turn):+.1f}°, '
            f'C_y^F by {changes.board("lift", name, turn):+.1f} % and, with the lean, the outward '
            f'force on the board by {changes.board("outward", name, turn):+.1f} %.'
        )
        checks.append(_size(changes, 'spread', 'door_spread', name, turn, reason))
    return claim('IV.C, Fig. 7', 'installation angles change the spread by 5-10 %', *checks)


def _opening(changes: Changes) -> Claim:
    faster, base = changes.faster, changes.base
    by_speed = {name: percent_change(faster, base, name) for name in RESULTS}
    by_turn = {name: changes.percent(name, 'epsilon', TURN) for name in RESULTS}
    exponent = np.log1p(by_speed['vertical_opening'] / 100.0) / np.log1p(
        by_speed['warp_tension'] / 100.0
    )
    pull = 100.0 * np.expm1(exponent * np.log1p(by_turn['warp_tension'] / 100.0))
    reason = (
        'the height of this mouth hardly depends on its width. Speed alone, which changes spread '
        f'by {by_speed["door_spread"]:+.1f} %, tension by {by_speed["warp_tension"]:+.1f} % and '
        f'opening by {by_speed["vertical_opening"]:+.1f} %, shows what the pull on the net does; '
        f'with ε +5° tension changes by {by_turn["warp_tension"]:+.1f} %, which is worth '
        f'{pull:+.1f} % of opening, and of its {by_turn["vertical_opening"]:+.1f} % there remain '
        f'{by_turn["vertical_opening"] - pull:+.1f} % for {by_turn["door_spread"]:+.1f} % of '
        'spread.'
    )
    checks = [
        _size(changes, 'opening', 'vertical_opening', name, turn, reason)
        for name, turn in changes.turned
        if name != 'zeta'
    ]
    return claim(
        'IV.C, Fig. 9', 'installation angles change the vertical opening by 5-10 %', *checks
    )


def _size(
    changes: Changes, word: str, quantity: str, name: str, turn: float, reason: str
) -> MeasuredValue:
    return MeasuredValue(
        f'size of the change of {word}, {label(name, turn)}',
        abs(changes.percent(quantity, name, turn)),
        '%',
        between(*SPAN),
        reason,
        key=f'{word}_{name}_{"up" if turn > 0 else "down"}',
    )


def _signs(changes: Changes) -> list[Claim]:
    def product(one: str, other: str, turn: tuple[str, float]) -> float:
        return changes.percent(one, *turn) * changes.percent(other, *turn)

    number = float(len(changes.turned))
    traded, not_traded = changes.against(
        lambda *turn: product('door_spread', 'vertical_opening', turn) < 0.0,
        'door_spread',
        'vertical_opening',
    )
    followed, not_followed = changes.against(
        lambda *turn: product('door_spread', 'warp_tension', turn) > 0.0,
        'door_spread',
        'warp_tension',
    )
    lifted, not_lifted = changes.against(
        lambda *turn: changes.board('lift', *turn) * changes.percent('door_spread', *turn) > 0.0,
        'door_spread',
    )
    return [
        claim(
            'IV.C, Fig. 7 and 9',
            'spread and opening trade off',
            MeasuredValue(
                'turns, of six, that change them in opposite directions',
                traded,
                target=at_least(number),
                note=f'not so with {not_traded}.',
                key='trade_off',
            ),
        ),
        claim(
            'IV.C, Fig. 7 and 10',
            'warp tension varies as spread does',
            MeasuredValue(
                'turns, of six, that change both in one direction',
                followed,
                target=at_least(number),
                note=f'not so with {not_followed}.',
                key='tension_follows',
            ),
        ),
        claim(
            'IV.C, Fig. 7 and 10',
            'because both are tied to the lift of the board',
            MeasuredValue(
                'turns, of six, in which C_y^F changes as the spread does',
                lifted,
                target=at_least(number),
                note=f'not so with {not_lifted}: there the lean of the board outweighs its lift.',
                key='lift_decides',
            ),
        ),
    ]
