"""Published panels of netting: the committed list, and the model's panel compared with it."""

import json

import pytest
from pydantic import ValidationError

from trawl_ros.gear.load import load_gear
from trawl_ros.lab.validation.panels.netting import added_by_knots, points_of, run
from trawl_ros.lab.validation.panels.published import PublishedPanels, published_panels
from trawl_ros.lab.validation.panels.whole_nets import WholeNet


@pytest.fixture(scope='module')
def published() -> PublishedPanels:
    return published_panels()


def test_three_solidities_count_from_3_to_90_degrees(published: PublishedPanels) -> None:
    counted = [panel for panel in published.panels if panel.use == 'counts']
    whole = [panel for panel in counted if panel.lift]
    assert len({panel.solidity for panel in whole}) >= 3
    for panel in whole:
        assert min(panel.angle_deg) <= 3.0
        assert max(panel.angle_deg) == 90.0


@pytest.mark.parametrize(
    ('change', 'message'),
    [
        ({'drag': (1.0,)}, 'drag: found 1 .*9'),
        ({'use': 'shown'}, 'why: missing'),
        ({'source': 'hearsay'}, 'found none named hearsay'),
    ],
)
def test_a_list_that_contradicts_itself_is_refused(
    published: PublishedPanels, change: dict[str, object], message: str
) -> None:
    data = published.model_dump(mode='json')
    data['panels'][0] |= change
    with pytest.raises(ValidationError, match=message):
        PublishedPanels.model_validate_json(json.dumps(data))


def test_the_model_stays_near_panels_at_the_angles_of_trawls(published: PublishedPanels) -> None:
    net = load_gear('krill_800').netting
    points = [p for panel in published.panels for p in points_of(panel, net)]
    for one in points:
        if one.panel.use == 'counts' and one.kind == 'drag' and 5.0 <= one.angle <= 15.0:
            assert abs(one.error) < 35.0, one
    for knot in published.knots:
        assert 0.5 * knot.more < added_by_knots(knot, net) < 1.6 * knot.more


def test_the_case_reaches_its_medians_and_draws_a_figure() -> None:
    findings = run(True)
    rows = {row.key: row for row in findings.rows}
    for key in ('drag_small', 'lift_small', 'small', 'across', 'solidities'):
        assert rows[key].ok, key
    assert {'bands', 'exponent'} <= set(rows)
    assert findings.drawings


def test_the_exponent_of_a_net_is_that_of_its_drag() -> None:
    net = WholeNet('net', 100.0, {2.0: 1.0}, {2.0: 3.0, 4.0: 3.0 * 2**1.6})
    assert net.exponent == pytest.approx(1.6)
    assert net.inside == [False]
