# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Claims of section IV.C on α, δ and the depth of turned boards, Fig. 8, 11 and 12."""

import numpy as np

from trawl_ros.lab.report.measured import MeasuredValue, at_least, at_most, within
from trawl_ros.lab.validation.paper.changes import Changes
from trawl_ros.lab.validation.paper.claim import Claim, claim
from trawl_ros.lab.validation.paper.sweeps import INSTALLATION, TURN


def turned_board_claims(changes: Changes) -> list[Claim]:
    """Return all claims on the boards themselves."""
    return [*_epsilon(changes), *_eta(changes), *_depth(changes)]


def _epsilon(changes: Changes) -> list[Claim]:
    why = (
        f'+5° of ε give {changes.degrees("attack", "epsilon", TURN):+.1f}° of α: the moment C_z^M '
        'and the tensions at the fastening points, which the paper does not print, share the turn.'
    )
    lean = (
        f'C_x^M changes by {changes.board("rolling", "epsilon", TURN):+.0f} %, and the tensions at '
        'the fastening points balance it with less lean than in the paper.'
    )
    return [
        claim(
            'IV.C, Fig. 11 and 12',
            'more ε raises α and δ, each by more than its own 5°',
            MeasuredValue(
                'change of α, ε +5°',
                changes.degrees('attack', 'epsilon', TURN),
                '°',
                at_least(TURN),
                why,
                key='epsilon_attack',
            ),
            MeasuredValue(
                'change of δ, ε +5°',
                changes.degrees('inclination', 'epsilon', TURN),
                '°',
                at_least(TURN),
                lean,
                key='epsilon_inclination',
            ),
        ),
        claim(
            'IV.C, Fig. 11 and 12',
            'with α the moment C_x^M grows, which raises δ',
            MeasuredValue(
                'change of C_x^M, ε +5°, as it tips the outward normal up',
                changes.board('rolling', 'epsilon', TURN),
                '%',
                at_least(0.0),
                why,
                key='epsilon_rolling',
            ),
        ),
    ]


def _eta(changes: Changes) -> list[Claim]:
    attack = changes.degrees('attack', 'eta', TURN)
    inclination = changes.degrees('inclination', 'eta', TURN)
    rolling = changes.board('rolling', 'eta', TURN)
    slip = np.degrees([changes.base.seen.port_slip, changes.found['eta'][TURN].seen.port_slip])
    weak = (
        f'+5° of η change α by {attack:+.1f}° and C_x^M by {rolling:+.1f} %, too little to take '
        f'back the lean that the turn gives; the slip angle goes from {slip[0]:.1f}° to '
        f'{slip[1]:.1f}°, a tilt fore and aft that δ of eq. 38 counts as well.'
    )
    return [
        claim(
            'IV.C, Fig. 12',
            'more η lowers α and raises δ',
            MeasuredValue('change of α, η +5°', attack, '°', at_most(0.0), weak, key='eta_attack'),
            MeasuredValue(
                'change of δ, η +5°', inclination, '°', at_least(0.0), weak, key='eta_inclination'
            ),
        ),
        claim(
            'IV.C, Fig. 12',
            'neither change is large (below the turn of 5° itself)',
            MeasuredValue(
                'size of the change of α, η +5°',
                abs(attack),
                '°',
                at_most(TURN),
                weak,
                key='eta_attack_small',
            ),
            MeasuredValue(
                'size of the change of δ, η +5°',
                abs(inclination),
                '°',
                at_most(TURN),
                weak,
                key='eta_inclination_small',
            ),
        ),
        claim(
            'IV.C, Fig. 12',
            'the lower α reduces C_x^M, which weakens the change of δ',
            MeasuredValue(
                'change of C_x^M, η +5°', rolling, '%', at_most(0.0), weak, key='eta_rolling'
            ),
        ),
    ]


def _depth(changes: Changes) -> list[Claim]:
    base, turned = changes.base.board, changes.found['epsilon'][TURN].board
    depth = {
        name: max(abs(changes.percent('door_depth', name, turn)) for turn in (TURN, -TURN))
        for name in INSTALLATION
    }
    change = changes.percent('door_depth', 'epsilon', TURN)
    upward = (turned.upward - base.upward) / 1e3
    tipped = 'the upward part of lift is C_y^F times the vertical part of the outward normal, {}.'
    return [
        claim(
            'IV.C, Fig. 11 and 12',
            'with more ε, the changes of α and of δ both raise the upward force',
            MeasuredValue(
                'change of upward lift by C_y^F alone, ε +5°',
                100.0 * (turned.lift / base.lift - 1.0),
                '%',
                at_least(0.0),
                tipped.format(f'and C_y^F goes from {base.lift:.2f} to {turned.lift:.2f}'),
                key='upward_by_attack',
            ),
            MeasuredValue(
                'change of upward lift by the lean alone, ε +5°',
                100.0 * (turned.normal / base.normal - 1.0),
                '%',
                at_least(0.0),
                tipped.format(f'which goes from {base.normal:.2f} to {turned.normal:.2f}'),
                key='upward_by_lean',
            ),
            MeasuredValue(
                'change of the upward force on a board, ε +5°',
                upward,
                'kN',
                at_least(0.0),
                tipped.format('less what drag and C_z^F take'),
                key='upward_force',
            ),
        ),
        claim(
            'IV.C, Fig. 8',
            'ε acts strongly on the depth of the boards',
            MeasuredValue(
                'largest change of depth by ε over the largest by ζ or η',
                depth['epsilon'] / max(depth['zeta'], depth['eta']),
                target=at_least(1.0),
                note='ζ and η tip the board as well, and its lift with it.',
                key='depth_by_epsilon',
            ),
        ),
        claim(
            'IV.C, Fig. 8',
            '+5° of ε reduce the depth of the boards by about 30 %',
            MeasuredValue(
                'change of door depth, ε +5°',
                change,
                '%',
                within(5.0, of=-30.0),
                f'the upward force on a board changes by {upward:+.1f} kN; the warp tension '
                f'is {changes.base.seen.warp_tension / 1e3:.0f} kN.',
                key='depth_epsilon',
            ),
        ),
    ]
