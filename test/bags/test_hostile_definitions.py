"""Definitions of message types that ask for too much, or bear names that code has too."""

from dataclasses import replace

import pytest

from trawl_ros.bags.storage import decoding
from trawl_ros.bags.storage.decoding import BagTypes
from trawl_ros.bags.storage.stored import Definition
from trawl_ros.core.errors import BagError, MessageError
from trawl_ros.core.limits import (
    BAG_FIELDS,
    DEFINITION_BYTES,
    DEFINITION_FIELDS,
    MESSAGE_OBJECTS,
)
from trawl_ros.messages.cdr import STORE, message_definition


def make(text, name='a/msg/B', encoding='ros2msg'):
    return Definition(name, 'cdr', encoding, text.encode())


def idl(constant, name='B'):
    return make(
        f'module a {{ module msg {{ module B_Constants {{ const long long X = {constant}; }}; '
        f'struct {name} {{ long x; }}; }}; }};',
        encoding='ros2idl',
    )


@pytest.mark.parametrize(
    ('said', 'words'),
    [
        (make('string[1000000] a'), 'fixed length'),
        (make('float64[99999999999999999999] a'), 'bytes'),
        (make('uint8[0] a'), '0 elements'),
        (make('B[] a'), 'nesting'),
        (make('Other a'), 'not defined'),
        (make('float64 a\n' * (DEFINITION_BYTES.value // 10 + 1)), str(DEFINITION_BYTES)),
        (
            make('\n'.join(f'bool a{n}' for n in range(DEFINITION_FIELDS.value + 1))),
            str(DEFINITION_FIELDS),
        ),
        (make('float64 a\nint8 a'), 'stands twice'),
        (make('float64 x', name='T'), 'name of the type'),
        (make('float64 x', name='a/msg/B\nfloat64 injected'), 'name of the type'),
        (idl('1 << 30000000000'), 'shift'),
        (idl('(4294967296 * 4294967296) * 2'), '64 bits'),
        (idl('(' * 1000 + '1' + ')' * 1000), 'Recursion'),
        (make('module a {' * 5000, encoding='ros2idl'), 'Recursion'),
    ],
)
def test_a_definition_that_asks_for_too_much_is_refused(said, words):
    with pytest.raises(BagError, match=words) as refused:
        BagTypes().store('/topic', said)
    assert '\n' not in str(refused.value)


@pytest.mark.parametrize('constant', ['(((5)))', '1 << 3 | 2 * 3', '-1', '~(1 + 1)'])
def test_constants_that_are_worked_out_are_read(constant):
    assert BagTypes().decoder('/topic', idl(constant))(b'\0\1\0\0\7\0\0\0').x == 7


@pytest.mark.parametrize('name', ['T', 'dataclass', 'FIELDDEFS', 'Typesdict', 'ClassVar'])
def test_a_type_may_be_named_as_something_in_code_is(name):
    said = make('uint8 x\nuint8 class\nuint8 self\nuint8 T\nuint8 typestore', f'a/msg/{name}')
    message = BagTypes().decoder('/topic', said)(b'\0\1\0\0\1\2\3\4\5')
    assert (message.x, message.class_, message.T) == (1, 2, 4)


def test_all_definitions_of_a_bag_share_a_count_of_fields(monkeypatch):
    # So many as are allowed take a while to make.
    monkeypatch.setattr(decoding, 'BAG_FIELDS', replace(BAG_FIELDS, value=2000))
    types = BagTypes()
    text = '\n'.join(f'uint8 a{n}' for n in range(90))
    for number in range(22):
        types.store(f'/topic{number}', make(text, f'a/msg/B{number}'))
    with pytest.raises(BagError, match='2000 fields'):
        types.store('/one_more', make(text, 'a/msg/More'))


def test_a_message_that_would_be_too_many_objects_is_refused():
    text = 'C[] many\n' + '=' * 80 + '\nMSG: a/C\nuint8 x\n'
    decode = BagTypes().decoder('/topic', make(text))
    count = MESSAGE_OBJECTS.value // 2
    assert len(decode(b'\0\1\0\0' + (9).to_bytes(4, 'little') + bytes(9)).many) == 9
    with pytest.raises(MessageError, match='objects'):
        decode(b'\0\1\0\0' + count.to_bytes(4, 'little') + bytes(count))


def test_a_definition_of_ros_2_that_is_written_otherwise_is_known_still():
    name = 'sensor_msgs/msg/JointState'
    assert (
        BagTypes().store('/topic', make('# a comment\n' + message_definition(name), name)) is STORE
    )
