"""Number formats of cells: decimal commas, positions in degrees and minutes."""

import math
import re
from typing import Literal

_DEGREES = re.compile(r'[°º˚d\'′’"″m\s:]+')
_NEGATIVE, _POSITIVE = ('S', 'W'), ('N', 'E')


def parse_number(text: str, decimal: Literal['.', ','] = '.') -> float:
    """Read a finite number.

    Raises
    ------
    ValueError
        If it is none; the text says what was expected.
    """
    if decimal == ',' and '.' in text:
        raise ValueError('a number with a decimal comma')
    try:
        value = float(text.replace(decimal, '.'))
    except ValueError:
        raise ValueError('a number') from None
    if not math.isfinite(value) or '_' in text:
        raise ValueError('a finite number')
    return value


def parse_degrees(text: str, decimal: Literal['.', ','] = '.') -> float:
    """Read degrees and minutes, and seconds if they are there, as degrees.

    Charts and plotters write ``57 30.5 N``, ``57°30.5'N``, ``W152°15'30"`` or, packed as in NMEA
    0183, ``5730.5``. South and west are negative.

    Raises
    ------
    ValueError
        If it is none of these; the text says what was expected.
    """
    expected = ValueError("degrees and minutes such as 57 30.5 N or 57°30.5'N")
    bare = text.strip().upper()
    letters = [letter for letter in (*_NEGATIVE, *_POSITIVE) if letter in bare]
    if len(letters) > 1:
        raise expected
    for letter in letters:
        bare = bare.replace(letter, ' ')
    sign = -1.0 if letters and letters[0] in _NEGATIVE else 1.0
    bare = bare.strip()
    if bare.startswith('-'):
        sign, bare = -sign, bare[1:]
    texts = [piece for piece in _DEGREES.split(bare.lower()) if piece]
    try:
        numbers = [parse_number(piece, decimal) for piece in texts]
    except ValueError:
        raise expected from None
    if len(numbers) == 1:
        degrees = math.floor(numbers[0] / 100)
        numbers = [float(degrees), numbers[0] - 100 * degrees]
    if not 2 <= len(numbers) <= 3 or min(numbers) < 0 or max(numbers[1:]) >= 60:
        raise expected
    angle: float = sign * sum(number / 60**place for place, number in enumerate(numbers))
    return angle


def hemisphere_sign(text: str) -> float:
    """Sign of N, S, E or W.

    Raises
    ------
    ValueError
        If it is none of these.
    """
    letter = text.strip().upper()[:1]
    if letter in _NEGATIVE:
        return -1.0
    if letter in _POSITIVE:
        return 1.0
    raise ValueError('N, S, E or W')
