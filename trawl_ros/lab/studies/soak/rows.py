"""Rows of a soak: memory, delay, pace, and the share of a core in real time."""

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise

import numpy as np
from scipy.stats import theilslopes

from trawl_ros.lab.report.row import StudyRow
from trawl_ros.lab.running.chain import CHAIN, CONSUMERS, Glance
from trawl_ros.lab.studies.soak.study import SETTLE_S, Soak

WARM_SHARE = 0.1
"""Share of the long tow after which memory and delay are held against themselves."""

MOST_GROWTH = 5.0
"""Growth of memory, per cent of its mean."""

ONE_CORE = 100.0
PIECES = 10
FEWEST = 10
"""Glances without which no trend is told."""


def soak_rows(soak: Soak) -> list[StudyRow]:
    """Return the rows of both runs."""
    warm = [g for g in soak.fast if g.data_s >= WARM_SHARE * 3600.0 * soak.plan.hours]
    towed = soak.fast[-1].data_s / 3600.0 if soak.fast else 0.0
    missing = max(0.0, soak.plan.hours - towed)
    # The last glance is a little before the end.
    nearly = soak.plan.hours * 0.01
    rows = [
        StudyRow('tow that is missing to the whole', missing, unit='h', target=nearly,
            note=f'{towed:.3g} of {soak.plan.hours:g} h at sea were towed'),
    ]  # fmt: skip
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


def _memory_growth(node: str, glances: Sequence[Glance]) -> StudyRow:
    seen = [g.memory_mb[node] for g in glances]
    growth, low, high = _trend(glances, lambda g: g.memory_mb[node])
    scale = 100.0 / float(np.mean(seen))
    return StudyRow(
        f'{node}: growth of memory', growth * scale, low * scale, high * scale, '% of its mean',
        MOST_GROWTH, 'median slope (Theil-Sen) times the time after warm-up; 95 % interval',
    )  # fmt: skip


def _memory(node: str, glances: Sequence[Glance]) -> StudyRow:
    seen = [g.memory_mb[node] for g in glances]
    note = 'resident; mean, least and most after warm-up'
    return StudyRow(f'{node}: memory', float(np.mean(seen)), min(seen), max(seen), 'MB', note=note)


def _delay_growth(node: str, glances: Sequence[Glance], most_s: float) -> StudyRow:
    growth, low, high = _trend(glances, lambda g: g.delay_s.get(node, np.nan))
    return StudyRow(
        f'{node}: growth of the delay', growth, low, high, 's', most_s,
        'at most one truth; median slope (Theil-Sen) times the time after warm-up; 95 % interval',
    )  # fmt: skip


def _delay(node: str, glances: Sequence[Glance]) -> StudyRow:
    seen = [g.delay_s[node] for g in glances if node in g.delay_s]
    note = (
        'time at sea between the newest truth and what the node has dealt with, as the study '
        'hears of both; mean, and least and most of means between two glances'
    )
    mean, least, most = (float(f(seen)) if seen else np.nan for f in (np.mean, min, max))
    return StudyRow(f'{node}: delay', mean, least, most, 's', note=note)


def _effort(node: str, glances: Sequence[Glance]) -> StudyRow:
    def of(piece: Sequence[Glance]) -> float:
        hours = (piece[-1].data_s - piece[0].data_s) / 3600.0
        return (piece[-1].cpu_s[node] - piece[0].cpu_s[node]) / hours

    pieces = [of(piece) for piece in _pieces(glances)]
    note = f'least and most of {len(pieces)} pieces of the tow'
    return StudyRow(f'{node}: processor time', of(glances), min(pieces), max(pieces),
               's per hour at sea', note=note)  # fmt: skip


def _pace(glances: Sequence[Glance]) -> StudyRow:
    pieces = [
        (piece[-1].data_s - piece[0].data_s) / (piece[-1].wall_s - piece[0].wall_s)
        for piece in _pieces(glances)
    ]
    whole = (glances[-1].data_s - glances[0].data_s) / (glances[-1].wall_s - glances[0].wall_s)
    note = f'least and most of {len(pieces)} pieces of the tow'
    return StudyRow('times real time', whole, min(pieces), max(pieces), note=note)


def _bag(soak: Soak, towed: float) -> StudyRow:
    return StudyRow('bag', soak.bag_mb / max(towed, 1e-9), unit='MB per hour at sea')


def _shares(glances: Sequence[Glance]) -> list[StudyRow]:
    """Share of a core used by each node in real time, and by all together."""
    note = f'least and most of {len(_pieces(glances))} pieces'
    rows = []
    for node in CHAIN:
        whole, low, high = _share(glances, _cpu_of(node))
        rows.append(StudyRow(f'{node}: in real time', whole, low, high, '% of a core', note=note))
    whole, low, high = _share(glances, lambda g: sum(g.cpu_s.values()))
    rows.append(StudyRow('the chain in real time', whole, low, high, '% of a core', ONE_CORE, note))
    first, last = glances[0], glances[-1]
    pace = (last.data_s - first.data_s) / (last.wall_s - first.wall_s)
    rows.append(StudyRow('pace asked to be real time', pace, unit='times real time'))
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


def series(glances: Sequence[Glance], by_node: Callable[[Glance], Mapping[str, float]], node: str
           ) -> tuple[list[float], list[float]]:  # fmt: skip
    """Return hours at sea and a node's values, where there are any."""
    seen = [(g.data_s / 3600.0, by_node(g)[node]) for g in glances if node in by_node(g)]
    return [x for x, _ in seen], [y for _, y in seen]
