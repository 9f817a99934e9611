"""Report of the study of hostile messages."""

import json
import math
from pathlib import Path

from trawl_ros.lab.report.row import StudyRow
from trawl_ros.lab.studies.hostile.study import MOST_MOVED, Found

REPORT = 'hostile_messages.json'


def rows_of(found: Found) -> list[StudyRow]:
    """Give the figures, and what was asked of them."""
    tallies, moved = found.tallies, found.moved
    sent = sum(sum(tally.sent.values()) for tally in tallies) + moved.sent
    ended = [tally.node for tally in tallies if tally.ended]
    mute = [tally.node for tally in tallies if not tally.answers]
    fields = sorted(name for tally in tallies for name in tally.not_finite)
    topics = sum(len(tally.sent) for tally in tallies)
    return [
        StudyRow('hostile messages', sent, least=100_000),
        StudyRow('subscriptions', topics),
        StudyRow(
            'messages that nodes refused and counted', sum(tally.refused for tally in tallies)
        ),
        StudyRow('nodes ended', len(ended), target=0, note=', '.join(ended)),
        StudyRow(
            'nodes that do not answer to sound messages any more',
            len(mute),
            target=0,
            note=', '.join(mute),
        ),
        StudyRow(
            'fields published with NaN or infinity', len(fields), target=0, note=', '.join(fields)
        ),
        StudyRow(
            'longest sentence on /diagnostics',
            max(t.longest_report for t in tallies),
            unit='characters',
            target=1000,
        ),
        StudyRow('hostile messages within the tow of the estimate', moved.sent),
        StudyRow('of these and their readings told to be refused', moved.told),
        StudyRow(
            'estimates moved silently',
            int(moved.shift > MOST_MOVED and not moved.told),
            target=0,
            note=f'{moved.windows[0]} windows undisturbed, {moved.windows[1]} of the same tow with '
            'hostile messages',
        ),
        StudyRow(
            'largest change of a coefficient',
            moved.shift,
            unit='std',
            note='' if math.isfinite(moved.shift) else 'no estimate, with a reason',
        ),
    ]


def write_hostile(folder: Path, found: Found, seed: int) -> list[StudyRow]:
    """Write ``hostile_messages.json`` into a folder; give its rows."""
    rows = rows_of(found)
    nodes = {
        tally.node: {
            'sent': sum(tally.sent.values()),
            'subscriptions': len(tally.sent),
            'refused': tally.refused,
            'ended': tally.ended,
            'answers afterwards': tally.answers,
        }
        for tally in found.tallies
    }
    content = {'seed': seed, 'rows': [row.record() for row in rows], 'nodes': nodes}
    folder.mkdir(parents=True, exist_ok=True)
    (folder / REPORT).write_text(json.dumps(content, indent=1) + '\n', encoding='utf-8')
    return rows
