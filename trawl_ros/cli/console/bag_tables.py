# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Output of ``trawl bag info`` and ``trawl bag check``."""

import json
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.filesize import decimal
from rich.markup import escape

from trawl_ros.bags.check import GROUPS, BagCheck, describe_qos
from trawl_ros.bags.reader import Bag, BagSummary
from trawl_ros.bags.sources import BagFacts
from trawl_ros.cli.console.tables import figure, plain_table
from trawl_ros.core.time import SECOND

UNKNOWN = 'unknown'


def summary_line(path: Path, count: int, start: int | None, end: int | None) -> str:
    """Summarise the content of a bag and its time span in a line."""
    if start is None or end is None:
        return f'{path}: no messages'
    begin = datetime.fromtimestamp(start / SECOND, UTC)
    minutes = (end - start) / SECOND / 60
    return f'{path}: {count} messages in {minutes:.1f} min from {begin:%F %T} UTC'


def kind(facts: BagFacts) -> str:
    """Describe the kind of a bag in a line."""
    words = [
        f'storage {facts.storage}',
        f'metadata version {facts.version}' if facts.version is not None else 'no metadata',
        f'ROS {facts.distro or UNKNOWN}',
        facts.compression or 'not compressed',
        f'{decimal(sum(facts.sizes.values()))} in {", ".join(facts.sizes)}',
    ]
    return ', '.join(words)


def print_info(bag: Bag, summary: BagSummary, console: Console) -> None:
    """Print the content of a bag."""
    console.print(
        escape(summary_line(summary.path, summary.count, summary.start, summary.end)),
        soft_wrap=True,
    )
    console.print(escape(kind(summary.facts)), soft_wrap=True)
    for key, text in bag.custom_data.items():
        first, *more = text.strip().splitlines() or ['']
        rest = f' … ({len(more)} more lines)' if more else ''
        console.print(escape(f'{key}: {first}{rest}'), soft_wrap=True)
    table = plain_table(
        'messages', 'Hz', 'kB', 'topic', 'type', 'QoS offered', right=('messages', 'Hz', 'kB')
    )
    offered = bag.offered()
    for topic in summary.topics:
        qos = '; '.join(dict.fromkeys(map(describe_qos, offered.get(topic.topic, ()))))
        cells = (
            str(topic.count),
            figure(topic.rate),
            f'{topic.bytes / 1e3:.0f}',
            topic.topic,
            topic.type,
            qos or UNKNOWN,
        )
        table.add_row(*map(escape, cells))
    console.print(table)


def info_as_json(bag: Bag, summary: BagSummary) -> str:
    """Return the content of a bag as JSON; times in ns, sizes in bytes."""
    offered = bag.offered()
    topics = [
        asdict(topic)
        | {
            'rate': topic.rate,
            'qos': [describe_qos(profile) for profile in offered.get(topic.topic, ())],
        }
        for topic in summary.topics
    ]
    record: dict[str, Any] = {
        **asdict(summary),
        'path': str(summary.path),
        'topics': topics,
        'custom_data': bag.custom_data,
    }
    return json.dumps(record, indent=2)


def print_check(check: BagCheck, console: Console) -> None:
    """Print the check of a bag, findings last."""
    console.print(
        escape(summary_line(check.path, check.count, check.start, check.end)), soft_wrap=True
    )
    console.print(escape(kind(check.facts)), soft_wrap=True)
    numbers = ('messages', 'Hz', 'usual Hz', 'longest gap s', 'back', 'same', 'log − stamp s')
    table = plain_table('topic', 'group', *numbers, 'QoS offered', right=numbers)
    marked = {finding.topic for finding in check.findings}
    for checked in check.topics:
        lag = (
            '–' if checked.lag_s is None else ' to '.join(f'{bound:.3g}' for bound in checked.lag_s)
        )
        cells = (
            checked.topic + (' *' if checked.topic in marked else ''),
            checked.group or 'other',
            str(checked.count),
            figure(checked.rate),
            figure(checked.usual_rate),
            figure(checked.longest_gap_s),
            str(checked.backward),
            str(checked.duplicates),
            lag,
            checked.qos or UNKNOWN,
        )
        table.add_row(*map(escape, cells))
    console.print(table)
    for group, names in check.missing.items():
        if names:
            missing = 'all' if len(names) == len(GROUPS[group]) else ', '.join(names)
            console.print(escape(f'Missing topics of {group}: {missing}'), soft_wrap=True)
    for finding in check.findings:
        where = f'{finding.topic} ' if finding.topic else ''
        console.print(escape(f'Found ({finding.kind}): {where}{finding.text}'), soft_wrap=True)
    number = len(check.findings)
    findings = '1 finding' if number == 1 else f'{number} findings'
    console.print(findings if number else 'Sound: nothing found')


def check_as_json(check: BagCheck) -> str:
    """Return the check of a bag as JSON; times in ns, sizes in bytes."""
    record = {'sound': check.sound, **asdict(check), 'path': str(check.path)}
    return json.dumps(record, indent=2)
