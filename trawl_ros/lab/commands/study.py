"""``trawl study``: what takes long to find out, measured and reported."""

from collections.abc import Mapping
from types import MappingProxyType

import click

from trawl_ros.cli.loaded_group import LoadedGroup

STUDIES: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        'soak': (
            'lab.commands.studies.soak',
            'Tow for a day through the ROS graph, and watch memory, delay and load.',
        ),
        'chaos': (
            'lab.commands.studies.chaos',
            'Stop and kill nodes, fill the disk, and see what is left of a tow.',
        ),
        'identification': (
            'lab.commands.studies.identification',
            'Ask of many trials what intervals and predictions are worth.',
        ),
        'motion': (
            'lab.commands.studies.motion',
            'Ask of tows in time what a fit of all of each is worth.',
        ),
        'instruments': (
            'lab.commands.studies.instruments',
            'Set simulated range sensors beside those of a survey.',
        ),
        'hostile': (
            'lab.commands.studies.hostile',
            'Send messages that make no sense to each subscription.',
        ),
        'discrepancy': (
            'lab.commands.studies.discrepancy',
            'Hide effects in trials of another plant, and count the findings.',
        ),
        'robustness': (
            'lab.commands.studies.robustness',
            'Change each number of a gear file, and tow random commands.',
        ),
        'onset': (
            'lab.commands.studies.onset',
            'Let effects begin during tows, and count how soon they are found.',
        ),
    }
)
"""Modules and sentences, as `LoadedGroup` has them."""


@click.group('study', cls=LoadedGroup, modules=STUDIES)
def command() -> None:
    """Measure what takes long to find out, and report it."""
