"""Published hauls: the committed list, and points beside the model."""

import math

import pytest
from pydantic import ValidationError

from trawl_ros.core.errors import TrawlError
from trawl_ros.gear.load import load_gear
from trawl_ros.lab.validation.sea.changes import CHANGES
from trawl_ros.lab.validation.sea.hauls import counted, run
from trawl_ros.lab.validation.sea.modelled import ModelledHaul, right_sign
from trawl_ros.lab.validation.sea.published import PublishedHauls, published_hauls
from trawl_ros.records.observables import OBSERVABLES, Observables


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
    with pytest.raises(TrawlError, match=r'haul 900 m of kaifuha.*found front weight'):
        haul.rigged(kaifuha)


def test_points_that_tuned_a_gear_do_not_count(published: PublishedHauls) -> None:
    hauls = [ModelledHaul(g, haul, seen()) for g in published.gears for haul in g.hauls]
    assert {one.haul.use for one, _ in counted(hauls)} == {'counts'}
    tuned = [one.haul for one in hauls if one.haul.use == 'tunes']
    assert [haul.name for haul in tuned] == ['drag at 1.45 m/s']


@pytest.mark.parametrize(
    ('change', 'message'),
    [
        ({'tuned': 'nothing'}, 'found tunes, where nothing is tuned'),
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


def test_a_trend_is_right_only_with_both_states(published: PublishedHauls) -> None:
    trend = published.trends[0]
    gear = next(gear for gear in published.gears if gear.gear == trend.gear)
    first, second = (
        next(haul for haul in gear.hauls if haul.name == name)
        for name in (trend.first, trend.second)
    )
    low = ModelledHaul(gear, first, seen(**{trend.quantity: 1.0}))
    high = ModelledHaul(gear, second, seen(**{trend.quantity: 2.0}))
    keys = (trend.gear, trend.first), (trend.gear, trend.second)
    assert trend.sign == 1
    assert right_sign(trend, dict(zip(keys, (low, high), strict=True)))
    assert not right_sign(trend, dict(zip(keys, (high, low), strict=True)))
    lost = ModelledHaul(gear, second, None)
    assert not right_sign(trend, dict(zip(keys, (low, lost), strict=True)))


def test_the_small_version_tells_its_points_beside_the_model() -> None:
    findings = run(small=True)
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
