"""Published hauls: the committed list, and points beside the model."""

import math

import pytest
from pydantic import ValidationError

from trawl_ros.core.errors import TrawlError
from trawl_ros.gear.load import load_gear
from trawl_ros.lab.validation.sea.changes import CHANGES
from trawl_ros.lab.validation.sea.hauls import counted, run
from trawl_ros.lab.validation.sea.modelled import ModelledHaul, is_right, modelled_trend
from trawl_ros.lab.validation.sea.published import (
    PublishedHauls,
    TrendRecord,
    published_hauls,
)
from trawl_ros.lab.validation.sea.tables import ratios_table, trends_table
from trawl_ros.records.observables import OBSERVABLES, Observables

FIRST, SECOND = '150 m, 1.1 m/s', '150 m, 1.8 m/s'
"""Two hauls of four_seam."""


def trend(**kind: object) -> TrendRecord:
    """Trend of the door spread between these hauls."""
    given = {'gear': 'four_seam', 'by': 'speed', 'quantity': 'door_spread', 'source': 'lee_1986'}
    return TrendRecord.model_validate({**given, 'first': FIRST, 'second': SECOND, **kind})


def towed(
    published: PublishedHauls, first: float | None, second: float | None
) -> dict[tuple[str, str], ModelledHaul]:
    """These hauls with door spreads (m) of the model; None without a steady state."""
    gear = next(gear for gear in published.gears if gear.gear == 'four_seam')
    hauls = {haul.name: haul for haul in gear.hauls}
    return {
        (gear.gear, name): ModelledHaul(
            gear, hauls[name], None if spread is None else seen(door_spread=spread)
        )
        for name, spread in ((FIRST, first), (SECOND, second))
    }


def seen(**values: float) -> Observables:
    """Observables that are zero but for these."""
    return Observables(**{**dict.fromkeys(OBSERVABLES, 0.0), **values})


@pytest.fixture(scope='module')
def published() -> PublishedHauls:
    return published_hauls()


def test_every_haul_can_be_rigged_and_has_a_source(published: PublishedHauls) -> None:
    for gear in published.gears:
        assert gear.source in published.sources
        record = load_gear(gear.gear)
        for haul in gear.hauls:
            weights = {item.name: item.weight_in_water_n for item in haul.rigged(record).hung}
            for name, newton in haul.hung_weight_in_water_n.items():
                assert weights[name] == newton


def test_a_weight_that_the_gear_has_not_is_named(published: PublishedHauls) -> None:
    haul = published.gears[0].hauls[1]
    kaifuha = load_gear('kaifuha')
    with pytest.raises(TrawlError, match=r'haul 900 m.*kaifuha.*front weight'):
        haul.rigged(kaifuha)


def test_points_that_tuned_a_gear_do_not_count(published: PublishedHauls) -> None:
    hauls = [ModelledHaul(g, haul, seen()) for g in published.gears for haul in g.hauls]
    assert {one.haul.use for one, _ in counted(hauls)} == {'counts'}
    tuned = [one.haul for one in hauls if one.haul.use == 'tunes']
    assert [haul.name for haul in tuned] == ['drag at 1.45 m/s']


@pytest.mark.parametrize(
    ('change', 'message'),
    [
        ({'tuned': 'nothing'}, 'found tunes'),
        ({'source': 'hearsay'}, 'found none named hearsay'),
        ({'hauls': 2}, 'expected each once'),
    ],
)
def test_a_list_that_contradicts_itself_is_refused(
    published: PublishedHauls, change: dict[str, object], message: str
) -> None:
    data = published.model_dump()
    gear = next(gear for gear in data['gears'] if gear['gear'] == 'four_seam')
    if 'hauls' in change:
        gear['hauls'] = gear['hauls'] * 2
    else:
        gear.update(change)
    with pytest.raises(ValidationError, match=message):
        PublishedHauls.model_validate(data)


def test_an_error_is_relative_and_infinite_without_a_steady_state(
    published: PublishedHauls,
) -> None:
    gear = published.gears[0]
    haul = gear.hauls[0]
    point = haul.points[0]
    right = ModelledHaul(gear, haul, seen(vertical_opening=0.9 * point.value))
    assert right.error(point) == pytest.approx(-10.0)
    assert ModelledHaul(gear, haul, None, 'none').error(point) == math.inf


@pytest.mark.parametrize(
    ('kind', 'spreads', 'right'),
    [
        ({'sign': 1}, (1.0, 2.0), True),
        ({'sign': 1}, (2.0, 1.0), False),
        ({'sign': -1}, (2.0, 1.0), True),
        ({'sign': 1}, (1.0, None), False),
        ({'within': 1.5}, (50.0, 51.0), True),
        ({'within': 1.5}, (51.0, 50.0), True),
        ({'within': 1.5}, (50.0, 52.0), False),
        ({'within': 1.5}, (None, 50.0), False),
    ],
)
def test_a_sign_or_bound_is_right_only_with_both_states(
    published: PublishedHauls,
    kind: dict[str, object],
    spreads: tuple[float | None, float | None],
    right: bool,
) -> None:
    assert trend(**kind).counts
    assert is_right(trend(**kind), towed(published, *spreads)) == right


def test_ratios_and_slopes_are_of_the_models_own_changes(published: PublishedHauls) -> None:
    hauls = towed(published, 50.0, 56.0)
    ratio, slope = trend(ratio=1.05), trend(slope=3.0, per='speed_kn')
    assert not ratio.counts
    assert modelled_trend(ratio, hauls) == pytest.approx(1.12)
    assert modelled_trend(slope, hauls) == pytest.approx(6.0 / (3.4989 - 2.1382))
    assert math.isnan(modelled_trend(slope, towed(published, 50.0, None)))
    trends = [ratio, slope, trend(sign=1)]
    assert [row[4:6] for row in ratios_table(trends, hauls).rows] == [
        ('+5.0 %', '+12.0 %'),
        ('3.000 per knot', '4.409 per knot'),
    ]
    assert len(trends_table(trends, hauls).rows) == 1


@pytest.mark.parametrize(
    ('kind', 'message'),
    [
        ({}, 'found none'),
        ({'sign': 1, 'ratio': 1.2}, 'found sign, ratio'),
        ({'slope': 1.0}, 'per: .* slope'),
        ({'sign': 1, 'per': 'warp_m'}, 'per: .* slope'),
    ],
)
def test_a_trend_is_of_one_kind(kind: dict[str, object], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        trend(**kind)


def test_a_slope_is_between_two_values(published: PublishedHauls) -> None:
    data = published.model_dump()
    data['trends'] = (trend(slope=0.3, per='warp_m').model_dump(),)
    with pytest.raises(ValidationError, match='found the same warp_m'):
        PublishedHauls.model_validate(data)


def test_the_small_version_tells_its_points_beside_the_model() -> None:
    findings = run(quick=True)
    rows = {row.key: row for row in findings.rows}
    assert rows['found'].value == 100.0
    assert rows['points'].value == 2.0
    assert 0.0 < rows['median_error'].value < 40.0
    points = findings.tables[0]
    assert [row[5] for row in points.rows] == ['26.0 m', '30.0 m']
    assert all(row[8] == 'counts' for row in points.rows)


def test_changes_leave_the_gear_file_alone_but_for_what_they_say() -> None:
    gear = load_gear('krill_1600')
    single, strumming, drag, faster, _, twine, flat, bare = CHANGES
    plan = single.gear(gear).netting.plan
    assert plan is not None
    assert not plan.shielded
    assert single.gear(gear).warp == gear.warp
    assert strumming.gear(gear).warp.normal_drag > 1.5 * gear.warp.normal_drag
    assert strumming.gear(gear).bridle == gear.bridle
    assert [effect.name for effect in drag.gear(gear).effects] == ['net_drag']
    assert faster.gear(gear) == gear
    assert faster.speed > 1.0
    assert twine.gear(gear).netting.viscous == flat.gear(gear).netting.lift == 0.0
    assert [item.name for item in bare.gear(gear).hung] == ['front weight', 'chain']
