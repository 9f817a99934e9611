"""Rows of the attack with hostile messages."""

import math

from endurance.hostile_messages.run import MOST_MOVED, AttackResults
from trawl_ros.lab.report.measured import MeasuredValue, at_least, at_most


def measured_rows(found: AttackResults) -> list[MeasuredValue]:
    """Give the figures, and what was asked of them."""
    tallies, moved = found.tallies, found.moved
    sent = sum(sum(tally.sent.values()) for tally in tallies) + moved.sent
    ended = [tally.node for tally in tallies if tally.ended]
    mute = [tally.node for tally in tallies if not tally.answers]
    fields = sorted(name for tally in tallies for name in tally.not_finite)
    topics = sum(len(tally.sent) for tally in tallies)
    return [
        MeasuredValue('hostile messages', sent, target=at_least(100_000)),
        MeasuredValue('subscriptions', topics),
        MeasuredValue(
            'messages that nodes refused and counted', sum(tally.refused for tally in tallies)
        ),
        MeasuredValue('nodes ended', len(ended), target=at_most(0), note=', '.join(ended)),
        MeasuredValue(
            'nodes that do not answer to sound messages any more',
            len(mute),
            target=at_most(0),
            note=', '.join(mute),
        ),
        MeasuredValue(
            'fields published with NaN or infinity',
            len(fields),
            target=at_most(0),
            note=', '.join(fields),
        ),
        MeasuredValue(
            'longest sentence on /diagnostics',
            max(t.longest_report for t in tallies),
            'characters',
            at_most(1000),
        ),
        MeasuredValue('hostile messages within the tow of the estimate', moved.sent),
        MeasuredValue('of these and their readings told to be refused', moved.told),
        MeasuredValue(
            'estimates moved silently',
            int(moved.shift > MOST_MOVED and not moved.told),
            target=at_most(0),
            note=f'{moved.windows[0]} windows undisturbed, {moved.windows[1]} of the same tow with '
            'hostile messages',
        ),
        MeasuredValue(
            'largest change of a coefficient',
            moved.shift,
            'std',
            note='' if math.isfinite(moved.shift) else 'no estimate, with a reason',
        ),
    ]
