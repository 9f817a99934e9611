"""A node that starts says what it does, on what, and with which topics."""

from trawl_ros.nodes.runtime.node import introduction


class Node:
    """Tows a `gear`
    by a scenario. And more.

    At length.
    """


class Silent(Node):
    pass


def test_it_fits_two_lines():
    values = {'gear': 'kaifuha', 'scenario': '', 'time_scale': 0.0, 'lead_s': 3.0}
    published = [f'/trawl/truth/{number}' for number in range(8)]
    topics = {'publishes': published, 'listens to': ['/trawl/command/winch', '/clock'], 'x': []}
    what, where = introduction(Node, values, '/trawl', topics)
    assert what.endswith('(gear kaifuha, time_scale 0.0)')
    assert where.startswith('in /trawl: publishes truth/0, truth/1, ')
    assert 'truth/5 and 2 more' in where
    assert where.endswith(' command/winch, /clock')


def test_who_does_not_say_what_it_does_has_nothing_to_say():
    assert introduction(Silent, {}, '/trawl', {'publishes': ['a']}) == []
