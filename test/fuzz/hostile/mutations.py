"""Sound content with something wrong put into it, for readers of any kind of file."""

from collections.abc import Callable, Sequence

from hypothesis import strategies as st
from hypothesis.strategies import DrawFn, SearchStrategy

Edit = Callable[[DrawFn, bytearray], None]


def mutated(
    sound: SearchStrategy[bytes], pieces: Sequence[bytes] = (), most: int = 6
) -> SearchStrategy[bytes]:
    """Sound content with some edits: bits flipped, parts cut out, repeated or replaced.

    Parameters
    ----------
    sound
        Content to begin with.
    pieces
        What may be put in beside random bytes: words of the format, impossible numbers.
    most
        Edits at most.
    """

    @st.composite
    def build(draw: DrawFn) -> bytes:
        content = bytearray(draw(sound))
        for _ in range(draw(st.integers(1, most))):
            draw(st.sampled_from(edits))(draw, content)
        return bytes(content)

    def put(draw: DrawFn, content: bytearray) -> None:
        start, end = _part(draw, content, 8)
        content[start:end] = draw(st.sampled_from(pieces))

    edits = [_flip, _byte, _cut, _repeat, _insert, _end]
    if pieces:
        edits += [put] * 4
    return build()


def long(unit: SearchStrategy[bytes], most: int) -> SearchStrategy[bytes]:
    """One piece many times over, up to so many bytes."""
    return st.tuples(unit, st.integers(1, most)).map(
        lambda chosen: chosen[0] * (chosen[1] // max(1, len(chosen[0])))
    )


def _part(draw: DrawFn, content: bytearray, longest: int) -> tuple[int, int]:
    start = draw(st.integers(0, len(content)))
    return start, draw(st.integers(start, min(len(content), start + longest)))


def _flip(draw: DrawFn, content: bytearray) -> None:
    if content:
        content[draw(st.integers(0, len(content) - 1))] ^= 1 << draw(st.integers(0, 7))


def _byte(draw: DrawFn, content: bytearray) -> None:
    if content:
        content[draw(st.integers(0, len(content) - 1))] = draw(st.integers(0, 255))


def _cut(draw: DrawFn, content: bytearray) -> None:
    start, end = _part(draw, content, len(content))
    del content[start:end]


def _repeat(draw: DrawFn, content: bytearray) -> None:
    start, end = _part(draw, content, 200)
    content[start:start] = content[start:end] * draw(st.sampled_from((1, 2, 10, 100)))


def _insert(draw: DrawFn, content: bytearray) -> None:
    start = draw(st.integers(0, len(content)))
    content[start:start] = draw(st.binary(max_size=16))


def _end(draw: DrawFn, content: bytearray) -> None:
    del content[draw(st.integers(0, len(content))) :]
