"""Statuses of estimator, diagnosis and trial as estimates and notes to be shown."""

from collections.abc import Iterator, Sequence

from trawl_ros.core.foreign import one_line
from trawl_ros.core.limits import DIAGNOSIS
from trawl_ros.messages.diagnostics import ERROR, OK, Status, read_number
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.view.records import Coefficients, Interval, Level, Note

COEFFICIENT_STATUS = 'identification: coefficients'


def coefficients_of(stamp: int, statuses: Sequence[Status]) -> Coefficients | None:
    """Read the estimate from the statuses of an identification.

    Returns
    -------
    Coefficients or None
        None before there is an estimate.

    Raises
    ------
    MessageError
        If a number of it is none.
    """
    status = next((status for status in statuses if status.name == COEFFICIENT_STATUS), None)
    if status is None or COEFFICIENTS[0] not in status.values:
        return None
    intervals = {
        name: Interval(
            read_number(status, name),
            read_number(status, f'{name} low'),
            read_number(status, f'{name} high'),
            status.values.get(f'{name} determined') == 'true',
        )
        for name in COEFFICIENTS
    }
    windows = int(read_number(status, 'windows'))
    return Coefficients(stamp, windows, intervals, one_line(status.message, DIAGNOSIS.value))


class NoteBook:
    """Notes that are new: each status of a topic is told when its sentence or its values change."""

    def __init__(self) -> None:
        self._told: dict[str, str] = {}

    def take(self, stamp: int, statuses: Sequence[Status], *, values: bool) -> Iterator[Note]:
        """Yield a note per status that says something new, with its values where these are wanted.

        A status may repeat what is foreign, so each note is one line of bounded length.
        """
        for status in statuses:
            told = ', '.join(f'{key} {value}' for key, value in status.values.items() if value)
            text = f'{status.message}; {told}' if values and told else status.message
            text = one_line(text, DIAGNOSIS.value)
            if self._told.get(status.name) != text:
                self._told[status.name] = text
                yield Note(stamp, one_line(status.name, DIAGNOSIS.value), _level(status), text)


def _level(status: Status) -> Level:
    if status.level == OK:
        return 'INFO'
    return 'ERROR' if status.level == ERROR else 'WARN'
