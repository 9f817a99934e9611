"""Rows of a soak: memory, delay, pace, and the share of a core in real time."""

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
from scipy.stats import theilslopes

from endurance.soak.run import SETTLE_S, Soak
from endurance.watching import Glance
from trawl_ros.lab.report.measured import MeasuredValue, at_most
from trawl_ros.lab.running.chain import CHAIN, CONSUMERS

WARM_SHARE = 0.1
"""Share of the long tow after which memory and delay are held against themselves."""

MOST_GROWTH = 5.0
"""Growth of memory, per cent of its mean."""

ONE_CORE = 100.0
PIECES = 10
FEWEST = 10
"""Glances without which no trend is told."""


def soak_rows(soak: Soak) -> list[MeasuredValue]:
    """Return the rows of both runs."""
    warm = [g for g in soak.fast if g.data_s >= WARM_SHARE * 3600.0 * soak.plan.hours]
    towed = soak.fast[-1].data_s / 3600.0 if soak.fast else 0.0
    missing = max(0.0, soak.plan.hours - towed)
    # The last glance is a little before the end.
    nearly = soak.plan.hours * 0.01
    rows = [
        MeasuredValue(
            'tow that is missing to the whole',
            missing,
            'h',
            at_most(nearly),
            f'{towed:.3g} of {soak.plan.hours:g} h at sea were towed',
        ),
    ]
    if len(warm) >= FEWEST:
        rows += [_memory_growth(node, warm) for node in CHAIN]
        rows += [_memory(node, warm) for node in CHAIN]
        rows += [_delay_growth(node, warm, 1.0 / soak.plan.truth_rate_hz) for node in CONSUMERS]
        rows += [_delay(node, warm) for node in CONSUMERS]
        rows += [_effort(node, warm) for node in CHAIN]
        rows += [_pace(warm), _bag(soak, towed)]
    counted = [g for g in soak.real if g.wall_s >= SETTLE_S]
    if len(counted) > 1:
        rows += _shares(counted)
    return rows


def _memory_growth(node: str, glances: Sequence[Glance]) -> MeasuredValue:
    seen = [g.memory_mb[node] for g in glances]
    growth, low, high = _trend(glances, lambda g: g.memory_mb[node])
    scale = 100.0 / float(np.mean(seen))
    return MeasuredValue(
        f'{node}: growth of memory',
        growth * scale,
        '% of its mean',
        at_most(MOST_GROWTH),
        'median slope (Theil-Sen) times the time after warm-up; 95 % interval',
        low=low * scale,
        high=high * scale,
    )


def _memory(node: str, glances: Sequence[Glance]) -> MeasuredValue:
    seen = [g.memory_mb[node] for g in glances]
    note = 'resident; mean, least and most after warm-up'
    return MeasuredValue(
        f'{node}: memory', float(np.mean(seen)), 'MB', note=note, low=min(seen), high=max(seen)
    )


def _delay_growth(node: str, glances: Sequence[Glance], most_s: float) -> MeasuredValue:
    growth, low, high = _trend(glances, lambda g: g.delay_s.get(node, np.nan))
    return MeasuredValue(
        f'{node}: growth of the delay',
        growth,
        's',
        at_most(most_s),
        'at most one truth; median slope (Theil-Sen) times the time after warm-up; 95 % interval',
        low=low,
        high=high,
    )


def _delay(node: str, glances: Sequence[Glance]) -> MeasuredValue:
    seen = [g.delay_s[node] for g in glances if node in g.delay_s]
    note = (
        'time at sea between the newest truth and what the node has dealt with, as the study '
        'hears of both; mean, and least and most of means between two glances'
    )
    mean, least, most = (float(f(seen)) if seen else np.nan for f in (np.mean, min, max))
    return MeasuredValue(f'{node}: delay', mean, 's', note=note, low=least, high=most)


def _effort(node: str, glances: Sequence[Glance]) -> MeasuredValue:
    def of(piece: Sequence[Glance]) -> float:
        hours = (piece[-1].data_s - piece[0].data_s) / 3600.0
        return (piece[-1].cpu_s[node] - piece[0].cpu_s[node]) / hours

    pieces = [of(piece) for piece in _pieces(glances)]
    note = f'least and most of {len(pieces)} pieces of the tow'
    return MeasuredValue(
        f'{node}: processor time',
        of(glances),
        's per hour at sea',
        note=note,
        low=min(pieces),
        high=max(pieces),
    )


def _pace(glances: Sequence[Glance]) -> MeasuredValue:
    pieces = [
        (piece[-1].data_s - piece[0].data_s) / (piece[-1].wall_s - piece[0].wall_s)
        for piece in _pieces(glances)
    ]
    whole = (glances[-1].data_s - glances[0].data_s) / (glances[-1].wall_s - glances[0].wall_s)
    note = f'least and most of {len(pieces)} pieces of the tow'
    return MeasuredValue('times real time', whole, note=note, low=min(pieces), high=max(pieces))


def _bag(soak: Soak, towed: float) -> MeasuredValue:
    return MeasuredValue('bag', soak.bag_mb / max(towed, 1e-9), 'MB per hour at sea')


def _shares(glances: Sequence[Glance]) -> list[MeasuredValue]:
    """Share of a core used by each node in real time, and by all together."""
    note = f'least and most of {len(_pieces(glances))} pieces'
    rows = []
    for node in CHAIN:
        whole, low, high = _share(glances, _cpu_of(node))
        rows.append(
            MeasuredValue(
                f'{node}: in real time', whole, '% of a core', note=note, low=low, high=high
            )
        )
    whole, low, high = _share(glances, lambda g: sum(g.cpu_s.values()))
    rows.append(
        MeasuredValue(
            'the chain in real time',
            whole,
            '% of a core',
            at_most(ONE_CORE),
            note,
            low=low,
            high=high,
        )
    )
    first, last = glances[0], glances[-1]
    pace = (last.data_s - first.data_s) / (last.wall_s - first.wall_s)
    rows.append(MeasuredValue('pace asked to be real time', pace, 'times real time'))
    return rows


def _cpu_of(node: str) -> Callable[[Glance], float]:
    return lambda glance: glance.cpu_s[node]


def _share(
    glances: Sequence[Glance], used: Callable[[Glance], float]
) -> tuple[float, float, float]:
    def of(piece: Sequence[Glance]) -> float:
        return 100.0 * (used(piece[-1]) - used(piece[0])) / (piece[-1].wall_s - piece[0].wall_s)

    pieces = [of(piece) for piece in _pieces(glances)]
    return of(glances), min(pieces), max(pieces)


def _pieces(glances: Sequence[Glance]) -> list[Sequence[Glance]]:
    """Cut into at most `PIECES` stretches that share their ends."""
    number = min(PIECES, len(glances) - 1)
    ends = np.linspace(0, len(glances) - 1, number + 1).round().astype(int)
    return [glances[a : b + 1] for a, b in pairwise(ends.tolist())]


def _trend(
    glances: Sequence[Glance], value: Callable[[Glance], float]
) -> tuple[float, float, float]:
    """Growth over the whole stretch with the ends of its 95 % interval."""
    known = [(g.data_s, value(g)) for g in glances if not np.isnan(value(g))]
    times, values = np.array(known).T if known else np.zeros((2, 0))
    if len(times) < FEWEST:
        return np.nan, np.nan, np.nan
    slope, _, low, high = theilslopes(values, times, 0.95)
    span = times[-1] - times[0]
    return float(slope * span), float(low * span), float(high * span)
