"""The second part of the short demo: a log that errs is named, and the gear file has it."""

import json

import pytest
import yaml

from trawl_ros.core.progress import ignore
from trawl_ros.lab.demo.short_tows import ShortTows, diagnose_short_tows
from trawl_ros.lab.demo.summary import finding_lines

pytestmark = pytest.mark.slow


@pytest.fixture(scope='module')
def found(tmp_path_factory):
    folder = tmp_path_factory.mktemp('hidden')
    return folder, diagnose_short_tows(folder, ignore)


def test_the_log_is_named_and_its_error_is_in_the_interval(found):
    folder, finding = found
    assert json.loads((folder / 'diagnosis.json').read_text())['verdict'] == 'NAMED'
    assert finding.name == 'speed_log'
    bias = finding.numbers['effects'][0]['parameters']['bias']
    assert bias['low'] <= ShortTows().log_error_m_s <= bias['high']


def test_it_can_be_detected_and_the_page_says_from_which_size(found):
    folder, finding = found
    assert finding.sizes['times'] > 1.0
    assert f'{finding.sizes["times"]:.1f} ×' in finding_lines(finding)[1]
    assert 'detectable from' in (folder / 'report.html').read_text()


def test_the_repaired_gear_leaves_less(found):
    folder, finding = found
    effects = yaml.safe_load((folder / 'model.yaml').read_text())['effects']
    assert [effect['name'] for effect in effects] == ['speed_log']
    channels = finding.numbers['channels']
    for name in ('port_door_depth', 'net_depth', 'port_tension'):
        assert channels[name]['after'] < 0.5 * channels[name]['before']
    assert len(finding_lines(finding)) == 3
