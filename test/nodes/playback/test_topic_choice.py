"""Topics are chosen in a time that no neighbour's name of a topic blows up."""

import time

import pytest

pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from trawl_ros.core.errors import TrawlError
from trawl_ros.nodes.playback.recorded_qos import TopicChoice


def chosen(pattern, parameter='regex'):
    return TopicChoice((), (), {parameter: pattern}, ())


@pytest.mark.parametrize(
    ('pattern', 'topic'),
    [
        ('^(/[a-z]+)+$', '/' + 'a' * 253 + '_'),
        ('^/(a|a)*$', '/' + 'a' * 253 + '_'),
        ('(.*)*/(.*)*/(.*)*x', '/a' * 127),
        ('^(([a-z/])+.)+[A-Z]([a-z])+$', '/' + 'a' * 254),
    ],
)
@pytest.mark.parametrize('parameter', ['regex', 'exclude_regex'])
def test_no_name_takes_long(pattern, topic, parameter):
    choice = chosen(pattern, parameter)
    began = time.monotonic()
    for _ in range(100):
        assert topic not in choice
    assert time.monotonic() - began < 1.0


def test_a_match_anywhere_in_the_name_counts():
    choice = chosen('sonar/(bottom|opening_.*)$')
    assert '/trawl/sonar/opening_height' in choice
    assert '/trawl/sonar/image' not in choice


@pytest.mark.parametrize('pattern', ['(', '(?!a)b', r'(a)\1', '((a{1000}){1000}){1000}', '[z-a]'])
def test_what_cannot_be_searched_in_time_is_refused(pattern):
    with pytest.raises(TrawlError, match=r'parameter regex: found '):
        chosen(pattern)
