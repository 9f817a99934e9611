"""Numbers as sentences have them: rounded, with leading zeros, degrees and minutes."""

import math
import re

from trawl_ros.sentences.table import SentenceField

_NUMBER = re.compile(r'[+-]?(?:\d{1,15}(?:\.\d{0,15})?|\.\d{1,15})')
_TURN = 2 * math.pi
NOT_A_NUMBER = 'a field that is no number'


def read_number(text: str, field: SentenceField) -> float:
    """Read the text of a reading as SI; NaN where it stands for none.

    Raises
    ------
    ValueError
        If it is no number.
    """
    bare = text.strip()
    if bare in field.missing:
        return math.nan
    if field.suffix:
        if not bare.endswith(field.suffix):
            raise ValueError(f'a field that does not end in {field.suffix!r}')
        bare = bare.removesuffix(field.suffix).strip()
    if not _NUMBER.fullmatch(bare):
        raise ValueError(NOT_A_NUMBER)
    number = float(bare)
    if field.unit == 'deg_min':
        degrees = math.floor(number / 100)
        minutes = number - 100 * degrees
        if number < 0 or minutes >= 60:
            raise ValueError(NOT_A_NUMBER)
        number = degrees + minutes / 60
    return number * field.size


def write_number(value: float, field: SentenceField) -> str:
    """Write a reading (SI) as its field has it, rounded; NaN as what stands for none.

    Positions lose their sign, which stands in the field of the hemisphere.
    """
    if not math.isfinite(value):
        return field.missing[0]
    number = value / field.size
    if field.unit == 'deg_min':
        steps = round(abs(number) * 60 * 10**field.decimals)
        degrees, rest = divmod(steps, 60 * 10**field.decimals)
        minutes = f'{rest / 10**field.decimals:0{field.decimals + 3}.{field.decimals}f}'
        return f'{degrees:0{max(field.digits - 2, 1)}d}{minutes}{field.suffix}'
    text = f'{number:.{field.decimals}f}'
    turn = _TURN / abs(field.size)
    if field.target[1].startswith('compass_') and float(text) >= turn - 1e-9:
        text = f'{float(text) - turn:.{field.decimals}f}'
    if float(text) == 0.0:
        text = text.removeprefix('-')
    if field.digits:
        whole, point, decimals = text.lstrip('-').partition('.')
        text = '-' * text.startswith('-') + whole.zfill(field.digits) + point + decimals
    return text + field.suffix
