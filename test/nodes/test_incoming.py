"""Whatever arrives, a node counts it, says in a line why it is not used, and lives on."""

import contextlib
import itertools

import numpy as np
import pytest

from endurance.hostile_messages.mutations import hostile_bytes
from trawl_ros.core.errors import MessageError, TrawlError
from trawl_ros.core.limits import IMAGE_BYTES, MESSAGE_BYTES
from trawl_ros.core.time import SECOND
from trawl_ros.messages.cdr import STORE, serialize
from trawl_ros.messages.commands import winch_command
from trawl_ros.messages.stamps import header
from trawl_ros.messages.truth_to_messages import clock_message
from trawl_ros.nodes.graph.source import Source
from trawl_ros.nodes.runtime.incoming import Incoming, Turns, believing_clock, decoding

JOINTS = 'sensor_msgs/msg/JointState'
WINCH = 'winch/joint_states'


class Wall:
    """Wall time that passes when told to."""

    time = 5.0

    def __call__(self):
        return self.time


def numbered(number):
    return {'publication_sequence_number': number}


def test_an_unforeseen_error_is_refused_with_its_place_in_one_line():
    said = []

    def use(message):
        raise ZeroDivisionError('nothing\nto divide by' * 10_000)

    Incoming(WINCH, use, said.append, print, Source(lambda: 1), True, Turns())(b'', numbered(1))
    (sentence,) = said
    assert sentence.startswith(f'{WINCH}: an error of ')
    assert 'ZeroDivisionError: nothing' in sentence
    assert len(sentence) < 300
    assert '\n' not in sentence


def test_an_error_with_which_the_node_cannot_do_its_work_ends_it():
    def use(message):
        raise TrawlError('no space left')

    ended = []
    Incoming(WINCH, use, print, ended.append, Source(lambda: 1), True, Turns())((b'', numbered(1)))
    assert ended == ['no space left']


@pytest.mark.parametrize(('kind', 'limit'), [(JOINTS, MESSAGE_BYTES),
                                             ('sensor_msgs/msg/Image', IMAGE_BYTES)])  # fmt: skip
def test_what_is_too_large_is_not_decoded(kind, limit, monkeypatch):
    monkeypatch.setattr(
        'trawl_ros.nodes.runtime.incoming.deserialize', lambda *_: pytest.fail('decoded')
    )
    take = decoding(WINCH, kind, print)
    with pytest.raises(MessageError, match=f'expected at most {limit}'):
        take(bytes(limit.value + 1))


def test_an_error_in_what_a_message_asks_for_is_the_messages():
    def use(message):
        raise TrawlError('no track')

    with pytest.raises(MessageError, match='no track'):
        decoding(WINCH, JOINTS, use)(serialize(winch_command(1, 2.0, 3.0)[1]))


@pytest.mark.parametrize('second', [-5, 2_147_483_647])
def test_a_false_clock_is_left_out(second):
    shown, refused = [], []
    show = believing_clock(lambda message: shown.append(message.clock.sec), refused.append)
    show(clock_message(100 * SECOND)[1])
    if second < 0:
        with pytest.raises(MessageError, match='/clock: -5 s'):
            show(clock_message(second * SECOND)[1])
    else:
        show(clock_message(second * SECOND)[1])
    show(clock_message(101 * SECOND)[1])
    assert shown == [100, 101]
    assert len(refused) == (second > 0)


class TestSource:
    """Two publishers number their messages each for itself."""

    @staticmethod
    def taken(source, numbers):
        return [source.take(number) for number in numbers]

    def test_stays_with_the_first_of_two(self):
        source = Source(lambda: 2, Wall())
        mixed = itertools.chain.from_iterable(zip(range(50, 60), range(1, 11), strict=True))
        assert self.taken(source, mixed) == [True, False] * 10
        assert source.lost == 0

    def test_goes_over_to_the_other_once_the_first_is_silent_for_three_of_its_periods(self):
        wall = Wall()
        source = Source(lambda: 2, wall)
        for first, second in ((50, 1), (51, 2)):
            assert self.taken(source, (first, second)) == [True, False]
            wall.time += 10.0
        wall.time += 19.0
        assert not source.take(3)
        wall.time += 2.0
        assert source.take(4)
        assert self.taken(source, (52, 5)) == [False, True]

    def test_one_that_is_started_anew_is_the_same_and_a_gap_is_a_loss(self):
        source = Source(lambda: 1, Wall())
        assert all(self.taken(source, (7, 8, 11, 1, 2)))
        assert source.lost == 2

    def test_a_node_that_was_killed_and_started_anew_is_heard_from_its_first_message(self):
        source = Source(lambda: 2, Wall(), namesakes=lambda: True)
        assert self.taken(source, (7, 8, 1, 2, 3)) == [True] * 5

    def test_of_twins_the_younger_one_stays(self):
        source = Source(lambda: 2, Wall(), namesakes=lambda: True)
        assert self.taken(source, (50, 1, 51, 2, 52, 3)) == [True, True, False, True, False, True]
        assert not source.take(55), 'a loss of the elder one is no new start'

    def test_without_numbers_none_of_two_is_used(self):
        assert Source(lambda: 1).take(None)
        assert not Source(lambda: 2).take(None)


rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from rclpy.impl.implementation_singleton import rclpy_implementation  # noqa: E402

from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.nodes.runtime.qos import CONSUMER  # noqa: E402


@pytest.fixture(scope='module')
def pair(open_graph):
    """A talker, and a listener that goes by /clock and fails on each reading of 13 m."""

    def use(message):
        if message.position[0] == 13.0:
            raise ZeroDivisionError('thirteen')
        heard.append(message)

    heard = []
    with open_graph() as graph:
        talker = graph.add(lambda **kwargs: TrawlNode('talker', **kwargs))
        ear = graph.add(lambda **kwargs: TrawlNode('ear', **kwargs), use_sim_time=True)
        ear.listen(WINCH, use, CONSUMER)
        talker.advertise(WINCH)
        talker.advertise('/clock')
        for topic in (WINCH, '/clock'):
            sender = talker._senders[topic]
            graph.until(lambda sender=sender: sender.get_subscription_count())
        yield graph, talker, ear, heard


def refused(node, topic):
    return node.traffic.counts('refused').get(topic, 0)


@pytest.mark.ros
def test_a_node_whose_handler_fails_says_so_and_hears_the_next(pair):
    graph, talker, ear, heard = pair
    for length in (13.0, 14.0):
        talker.send(WINCH, winch_command(SECOND, length, length)[1])
    graph.until(lambda: heard)
    assert refused(ear, '/trawl/winch/joint_states') == 1
    assert 'ZeroDivisionError: thirteen' in ear._traffic_status().message


@pytest.mark.ros
def test_three_hundred_thousand_names_make_one_line(pair):
    graph, talker, ear, _ = pair
    kind = STORE.types[JOINTS]
    names, none = [f'joint {number}' for number in range(300_000)], np.zeros(0)
    before = refused(ear, '/trawl/winch/joint_states')
    talker.send(WINCH, kind(header(SECOND, ''), names, none, none, none))
    graph.until(lambda: refused(ear, '/trawl/winch/joint_states') > before)
    assert len(ear._traffic_status().message) < 400


@pytest.mark.ros
def test_a_negative_clock_ends_no_node(pair):
    graph, talker, ear, _ = pair
    talker.send(*clock_message(100 * SECOND))
    graph.until(lambda: ear.now() == 100 * SECOND)
    talker.send(*clock_message(-5 * SECOND))
    graph.until(lambda: refused(ear, '/clock') == 1)
    talker.send(*clock_message(101 * SECOND))
    graph.until(lambda: ear.now() == 101 * SECOND)


@pytest.mark.ros
def test_bytes_that_are_no_message_come_through_the_middleware_and_end_no_node(pair):
    graph, talker, ear, heard = pair
    sound = {WINCH: winch_command(SECOND, 1.0, 2.0)[1], '/clock': clock_message(102 * SECOND)[1]}
    rng = np.random.default_rng(3)
    for number in range(200):
        for topic, message in sound.items():
            # Some the middleware sends for nobody.
            with contextlib.suppress(rclpy_implementation.RCLError):
                talker.send_bytes(
                    topic, hostile_bytes(serialize(message), message.__msgtype__, rng)
                )
        if number % 10 == 0:
            graph.rest(0.01)
    graph.settle()
    assert ear.exit_code is None
    before = len(heard)
    talker.send(WINCH, sound[WINCH])
    graph.until(lambda: len(heard) > before)


@pytest.mark.ros
def test_nothing_is_asked_of_the_middleware_while_it_hands_over_what_got_lost(pair):
    """Of a lost message it told one thread with a lock held that another one waited for."""
    _, _, ear, _ = pair
    assert not any(list(entry.event_handlers) for entry in ear.subscriptions)
