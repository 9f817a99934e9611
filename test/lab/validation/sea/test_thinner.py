"""Nets with less twine behind."""

import pytest

from trawl_ros.core.errors import TrawlError
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.validation.sea.published import HaulRecord, ThinnerRecord


def rigged(gear: GearRecord, change: ThinnerRecord) -> GearRecord:
    haul = HaulRecord(name='h', use='counts', warp_m=300, speed_kn=2, thinner=change, points=())
    return haul.rigged(gear)


@pytest.mark.parametrize('off', [0.11, 0.193])
def test_the_net_has_so_much_less_twine_and_all_of_it_from_small_meshes(off: float) -> None:
    gear = load_gear('krill_1420')
    new = rigged(gear, ThinnerRecord(mesh_up_to_mm=31, area_off=off)).netting.plan
    old = gear.netting.plan
    assert old is not None
    assert new is not None
    areas = [sum(piece.twine_area for piece in plan.pieces) for plan in (old, new)]
    assert areas[1] / areas[0] == pytest.approx(1.0 - off)
    for before, after in zip(old.pieces, new.pieces, strict=True):
        assert (before == after) == (before.mesh_mm > 31)
        assert before.twine_length == after.twine_length


@pytest.mark.parametrize(
    ('gear', 'area_off', 'words'),
    [('krill_1420', 0.5, r'thinner.* 0\.185'), ('kaifuha', 0.1, 'thinner: .*plan')],
    ids=['too much twine', 'no plan'],
)
def test_what_cannot_be_taken_off_is_refused(gear: str, area_off: float, words: str) -> None:
    with pytest.raises(TrawlError, match=f'{gear}: {words}'):
        rigged(load_gear(gear), ThinnerRecord(mesh_up_to_mm=9, area_off=area_off))
