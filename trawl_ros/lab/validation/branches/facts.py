# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Checks of a map of steady states: all usable states form one branch."""

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.lab.report.measured import MeasuredValue, at_least, at_most, within
from trawl_ros.lab.validation.branches.continuation import SAME_ROOT_M, Answer
from trawl_ros.lab.validation.branches.lattices import Lattice
from trawl_ros.model.board_law import LAW_RANGE
from trawl_ros.model.observables import COLLAPSED_NORMAL, outward_normal_lift
from trawl_ros.records.observables import Observables

MAX_ANSWER_S = 2.0
"""Longest allowed CPU time of an answer, s."""

MAX_ATTACK_STEP_DEG = 5.0
"""Change of the attack angle (°) between neighbours that indicates another branch.

It is less than half the difference between the boards' usual angles and the known collapsed ones.
"""

GROWING: dict[str, Callable[[Observables], float]] = {
    'door spread': lambda seen: seen.door_spread,
    'door depth': lambda seen: seen.door_depth,
    'tension': lambda seen: seen.warp_tension,
    'α': lambda seen: seen.port_attack,
}


def usable(lattices: Sequence[Lattice]) -> list[Answer]:
    """Return all usable answers."""
    return [
        answer
        for lattice in lattices
        for answer in lattice.answers.values()
        if answer.verdict == 'usable'
    ]


def branch_checks(name: str, lattices: Sequence[Lattice]) -> list[MeasuredValue]:
    """Checks that hold for any map; ``name`` begins their keys.

    Raises
    ------
    NoSteadyState
        If nothing on the map is usable.
    """
    good = usable(lattices)
    if not good:
        raise NoSteadyState(f'the map over {name} shows no usable steady state, expected some')
    every = [answer for lattice in lattices for answer in lattice.answers.values()]
    roots = [answer.usable for answer in good if answer.usable is not None]
    seen = [root.observables for root in roots]
    attacks = np.degrees([(each.port_attack, each.starboard_attack) for each in seen])
    normals = [outward_normal_lift(root.state).min() for root in roots]
    low, high = np.degrees(LAW_RANGE)
    searches = sum(answer.searches for answer in good)
    return [
        MeasuredValue(
            'distance between the states to which different starts lead, at usable places',
            max(answer.apart for answer in good),
            'm',
            at_most(SAME_ROOT_M),
            f'{searches} searches at {len(good)} places: from every neighbour, so both ways '
            'along each line of the map, and at every third place cold.',
            key=f'{name}_apart',
        ),
        MeasuredValue(
            'usable places at which some start found nothing',
            sum(not answer.agreed for answer in good),
            target=within(0.0, of=0.0),
            key=f'{name}_depends_on_start',
        ),
        MeasuredValue(
            'places with more than one usable state',
            sum(answer.usable_roots > 1 for answer in every),
            target=within(0.0, of=0.0),
            key=f'{name}_second_branch',
        ),
        MeasuredValue(
            'smallest attack angle of a usable state',
            float(attacks.min()),
            '°',
            at_least(low),
            'The range of eq. 14; on the collapsed branch α is negative, or above 40°.',
            key=f'{name}_lowest_attack',
        ),
        MeasuredValue(
            'largest attack angle of a usable state',
            float(attacks.max()),
            '°',
            at_most(high),
            key=f'{name}_highest_attack',
        ),
        MeasuredValue(
            'smallest vertical part of an outward normal in a usable state',
            float(np.min(normals)),
            target=at_least(COLLAPSED_NORMAL),
            note='A board counts as collapsed below this.',
            key=f'{name}_normal',
        ),
        MeasuredValue(
            'longest CPU time of one answer, refusals included',
            max(answer.seconds for answer in every),
            's',
            at_most(MAX_ANSWER_S),
            'Searches end after a fixed number of iterations, whatever they meet.',
            key=f'{name}_slowest',
        ),
    ]


def smoothness_checks(lattice: Lattice) -> Iterator[MeasuredValue]:
    """Check that a map over speed is smooth, and monotone in warp length where it should be."""
    yield MeasuredValue(
        'largest change of the attack angle from one usable place to the next',
        max(
            (
                abs(float(np.degrees(one.port_attack - other.port_attack)))
                for along in ((1, 0), (0, 1))
                for one, other in _neighbouring(lattice, along)
            ),
            default=0.0,
        ),
        '°',
        at_most(MAX_ATTACK_STEP_DEG),
        'A step onto another branch would show as a jump.',
        key='jump',
    )
    for k, (name, read) in enumerate(GROWING.items()):
        falls = sum(
            bool(read(long) <= read(short)) for short, long in _neighbouring(lattice, along=(1, 0))
        )
        yield MeasuredValue(
            f'steps of warp length, at one speed, along which {name} does not grow',
            falls,
            target=within(0.0, of=0.0),
            note='The paper, Fig. 6 and 13–16.',
            key=f'grows_{k + 1}',
        )


def _neighbouring(
    lattice: Lattice, along: tuple[int, int]
) -> Iterator[tuple[Observables, Observables]]:
    """Observables at usable places and at their usable neighbours in one direction."""
    for (i, j), here in lattice.answers.items():
        there = lattice.answers.get((i + along[0], j + along[1]))
        if there is not None and here.usable is not None and there.usable is not None:
            yield here.usable.observables, there.usable.observables
