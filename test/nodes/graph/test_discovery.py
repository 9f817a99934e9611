"""Nodes announce themselves more often than Fast DDS does, unless the user has a profile."""

from pathlib import Path
from xml.etree import ElementTree

import pytest

from trawl_ros.nodes.graph.discovery import FILES, VARIABLES, announce_often, variables

NAMES = {'p': 'http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles'}


def test_the_profile_of_the_package_is_named_and_holds_for_every_participant(tmp_path):
    environment = {}
    announce_often(environment, tmp_path)
    assert environment
    assert environment.keys() <= set(VARIABLES)
    (file,) = {Path(path) for path in environment.values()}
    (profile,) = ElementTree.parse(file).getroot().findall('p:participant', NAMES)
    assert profile.get('is_default_profile') == 'true'
    (period,) = profile.iterfind('.//p:leaseAnnouncement', NAMES)
    seconds, nanoseconds = (
        int(period.findtext(f'p:{key}', '', NAMES)) for key in ('sec', 'nanosec')
    )
    assert 0.0 < seconds + 1e-9 * nanoseconds <= 1.0


@pytest.mark.parametrize(
    ('version', 'named'),
    [('7.1.6', VARIABLES[1:]), ('9.1.2', VARIABLES[:1]), ('10.0', VARIABLES[:1]), ('', VARIABLES)],
)
def test_the_variable_is_that_of_the_distribution(version, named):
    assert variables(version) == named


@pytest.mark.parametrize('variable', VARIABLES)
def test_a_profile_that_the_user_names_stays(variable, tmp_path):
    environment = {variable: 'mine.xml'}
    announce_often(environment, tmp_path)
    assert environment == {variable: 'mine.xml'}


@pytest.mark.parametrize('name', FILES)
def test_a_profile_in_the_working_directory_stays(name, tmp_path):
    (tmp_path / name).write_text('<profiles/>')
    environment = {}
    announce_often(environment, tmp_path)
    assert environment == {}
