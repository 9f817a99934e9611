"""The table of instruments says what they publish, of which type, how often."""

import re
from pathlib import Path

import pytest

from trawl_ros.instruments.errors.faults import KINDS
from trawl_ros.instruments.parameters import GROUPS, load_instruments, observing
from trawl_ros.records.topics import INSTRUMENTS

PAGE = Path(__file__).parents[2] / 'docs' / 'instruments.md'

if not PAGE.is_file():
    pytest.skip('the documents are in a source checkout only', allow_module_level=True)


def rows() -> dict[str, tuple[str, float]]:
    """Type and rate by topic."""
    found = {}
    for line in PAGE.read_text().splitlines():
        cells = [cell.strip() for cell in line.strip('|').split('|')]
        if len(cells) == 5 and cells[3].endswith(' Hz'):
            for topic in re.findall(r'`([^`]+)`', cells[1]):
                found[topic] = cells[2].replace('/', '/msg/'), float(cells[3].split()[0])
    return found


def rates() -> dict[str, float]:
    """Rate by topic, of the default instruments."""
    default = load_instruments()
    door, sonar, vessel = default.door, default.sonar, default.vessel
    sides = ('port', 'starboard')
    return {
        'winch/joint_states': default.winch.rate_hz,
        **{f'door/{side}/pressure': door.pressure.rate_hz for side in sides},
        **{f'door/{side}/attitude': door.attitude.rate_hz for side in sides},
        'door/spread': door.spread.rate_hz,
        'sonar/pressure': sonar.pressure.rate_hz,
        'sonar/bottom': sonar.bottom.rate_hz,
        **{
            f'sonar/{what}': sonar.sweep.rate_hz
            for what in ('image', 'scan', 'points', 'opening_height', 'opening_width')
        },
        'vessel/velocity_water': vessel.velocity_water.rate_hz,
        'vessel/velocity_ground': vessel.velocity_ground.rate_hz,
        'vessel/fix': vessel.fix.rate_hz,
        'vessel/heading': vessel.heading.rate_hz,
        'vessel/echo_sounder/depth': vessel.echo_sounder.depth.rate_hz,
        'vessel/echo_sounder/school': vessel.echo_sounder.school.rate_hz,
        'vessel/fish_sonar': vessel.fish_sonar.rate_hz,
        **{
            row.name: errors.rate_hz
            for node, group in GROUPS.items()
            for row in observing(node)
            if (errors := getattr(getattr(default, group), row.errors))
        },
    }


def test_the_table_has_every_instrument_aboard_with_type_and_rate() -> None:
    expected = {
        topic.name: (topic.type, rates()[topic.name])
        for topic in INSTRUMENTS
        if topic.name in rates()
    }
    assert rows() == expected


def test_every_kind_of_fault_is_named() -> None:
    text = PAGE.read_text()
    assert [kind for kind in KINDS if f'`{kind}`' not in text] == []
