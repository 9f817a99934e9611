# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Conversion of a tow's messages, in order of arrival, into records to show."""

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any, assert_never

from trawl_ros.core.errors import MessageError
from trawl_ros.core.foreign import one_line
from trawl_ros.core.limits import DIAGNOSIS
from trawl_ros.core.time import SECOND
from trawl_ros.gear.records import GearRecord
from trawl_ros.messages.commands import read_vessel_command, read_winch_command
from trawl_ros.messages.diagnostics import ERROR, OK, Status, read_number, read_statuses
from trawl_ros.messages.estimates import INNOVATION, read_innovations
from trawl_ros.messages.from_messages import SAMPLE_TOPICS, to_sample
from trawl_ros.messages.pieces import read_vector
from trawl_ros.messages.point_clouds import read_point_cloud
from trawl_ros.messages.stamps import stamp_of
from trawl_ros.messages.truth_from_messages import schools_truth, seabed_truth
from trawl_ros.model.water import build_water
from trawl_ros.plots.moments import GEAR, MOUTH, SECTION
from trawl_ros.plots.reading import TRUTH, QuantityReader
from trawl_ros.plots.records import Quantities
from trawl_ros.records.samples import (
    FixSample,
    HeadingSample,
    PictureSample,
    Sample,
    SchoolsSample,
    SonarImageSample,
    SonarPointsSample,
    SonarScanSample,
)
from trawl_ros.records.topics import CONTRACT
from trawl_ros.records.truth import SIDES
from trawl_ros.view.gear_source import GearFollower
from trawl_ros.view.model_source import ModelFollower
from trawl_ros.view.records import (
    Coefficients,
    Echoes,
    Innovations,
    Interval,
    Level,
    Note,
    Schools,
    Section,
    SeenSchools,
    Shown,
    Sweep,
)
from trawl_ros.view.ship import ShipFollower

VESSEL, SCHOOLS, SEABED = 'truth/vessel/odom', 'truth/schools', 'truth/seabed'
IDENTIFICATION, FINDINGS, TRIAL = (
    'identification/status',
    'discrepancy/findings',
    'trial/status',
)
WINCH_COMMAND, VESSEL_COMMAND = 'command/winch', 'command/vessel'

TOPICS = tuple(row.name for row in CONTRACT if 'view_node' in row.heard_by)
"""Relative names of the topics that are shown."""

LAGGING = (IDENTIFICATION, INNOVATION, FINDINGS, TRIAL)
"""Topics stamped with the time of their window, which is computed later."""

COEFFICIENT_STATUS = 'identification: coefficients'

FAR_BACK_S = 120.0
"""Stamps further back than this belong to a new tow."""

SLOW_S = 1.0
"""Interval at which schools and the sonar's section are shown, however often truth comes."""


class TowReader:
    """Reader of the messages of a tow.

    Parameters
    ----------
    gear
        Its water turns pressure into depth, and its sizes draw the gear where markers do not.
    apart_s
        Between two shapes of the gear.
    model
        True to show also what the gear's model predicts in steady windows.
    """

    def __init__(self, gear: GearRecord, apart_s: float = 1.0, *, model: bool = False) -> None:
        self._quantity_reader = QuantityReader(build_water(gear).depth)
        self._ship = ShipFollower()
        self._gear = GearFollower(gear, self._ship, apart_s)
        self._model = ModelFollower(gear) if model else None
        self._newest: int | None = None
        self._due: dict[str, int] = {}
        self._sweeps = _SweepJoiner()
        self._notes = {topic: _NoteBook() for topic in (IDENTIFICATION, FINDINGS, TRIAL)}
        self._estimate: tuple[int, int] | None = None
        self._headrope_depth = math.nan

    def take(self, topic: str, message: Any) -> Iterator[Shown]:
        """Yield the records of a message.

        Parameters
        ----------
        topic
            Relative name, one of `TOPICS`.
        message
            Of the type of that topic, by whatever definition.

        Raises
        ------
        MessageError
            If it contradicts its topic.
        """
        try:
            records = list(self._records(topic, message))
        except MessageError:
            raise
        except (AttributeError, TypeError, ValueError, IndexError) as reason:
            raise MessageError(f'{topic}: not as its type has it ({reason})') from reason
        yield from records

    def model(self, topic: str, message: Any) -> Iterator[Shown]:
        """Yield the model's predictions, if asked for, from a message that is not shown itself.

        Raises
        ------
        MessageError
            If it contradicts its topic.
        """
        if self._model is not None and topic in SAMPLE_TOPICS:
            yield from self._model.take(to_sample(topic, message))

    def finish(self) -> Iterator[Shown]:
        """Yield the records that waited for more messages; no more follow."""
        if self._model is not None:
            yield from self._model.finish()

    def _records(self, topic: str, message: Any) -> Iterator[Shown]:
        stamp = _stamp(topic, message)
        newest = self._newest
        # A sweep is stamped at its first ping, seconds before it comes.
        moved = newest is None or stamp > newest or stamp < newest - FAR_BACK_S * SECOND
        if moved and topic not in LAGGING:
            # Of the instant before, which is complete.
            gear = None if newest is None else self._gear.drawn(newest)
            if gear is not None:
                yield gear
            self._newest = stamp
        if topic in SAMPLE_TOPICS:
            yield from self._sample(to_sample(topic, message))
        elif topic in TRUTH:
            yield from self._truth(topic, stamp, message)
        else:
            yield from _OTHERS[topic](self, stamp, message)

    def _quantities(self, quantities: Quantities) -> Iterator[Shown]:
        self._gear.take(quantities)
        yield quantities

    def _sample(self, sample: Sample) -> Iterator[Shown]:
        quantities = self._quantity_reader.sample(sample)
        if quantities.values:
            yield from self._quantities(quantities)
        if self._model is not None:
            yield from self._model.take(sample)
        if isinstance(sample, HeadingSample):
            self._ship.heading(sample.heading)
        elif isinstance(sample, FixSample):
            placed = self._ship.fix(sample)
            yield from (record for record in placed or () if record is not None)
        elif isinstance(sample, PictureSample):
            yield from self._picture(sample)

    def _picture(self, sample: PictureSample) -> Iterator[Shown]:
        match sample:
            case SchoolsSample():
                yield SeenSchools(sample.stamp, self._ship.in_map(sample.positions))
            case SonarPointsSample():
                yield Echoes(sample.stamp, sample.points)
            case SonarImageSample() | SonarScanSample():
                sweep = self._sweeps.take(sample)
                yield from () if sweep is None else (sweep,)
            case _:
                assert_never(sample)

    def _truth(self, topic: str, stamp: int, message: Any) -> Iterator[Shown]:
        quantities = self._quantity_reader.truth(topic, message)
        if topic == VESSEL:
            position = read_vector(message.pose.pose.position)
            yield self._ship.truth(stamp, position, quantities.values['heading'])
        self._headrope_depth = quantities.values.get('net_depth', self._headrope_depth)
        yield from self._quantities(quantities)

    def _markers(self, stamp: int, message: Any) -> Iterator[Shown]:
        gear = self._gear.markers(stamp, message)
        if gear is not None:
            yield gear

    def _mouth(self, stamp: int, message: Any) -> Iterator[Shown]:
        self._gear.mouth(stamp, message)
        yield from ()

    def _section(self, stamp: int, message: Any) -> Iterator[Shown]:
        if self._is_due(SECTION, stamp):
            yield Section(stamp, read_point_cloud(SECTION, message, ('x', 'y')))

    def _schools(self, stamp: int, message: Any) -> Iterator[Shown]:
        if self._is_due(SCHOOLS, stamp):
            yield Schools(stamp, schools_truth(message))

    def _seabed(self, stamp: int, message: Any) -> Iterator[Shown]:
        depths = seabed_truth(message)
        values = {
            'seabed': depths.under_headrope,
            'bottom': depths.under_headrope - self._headrope_depth,
            'depth': depths.under_ship,
        }
        known = {name: value for name, value in values.items() if math.isfinite(value)}
        if known:
            yield from self._quantities(Quantities(stamp, 'truth', known))

    def _identification(self, stamp: int, message: Any) -> Iterator[Shown]:
        statuses = read_statuses(message)
        estimate = _coefficients_of(stamp, statuses)
        if estimate is not None and self._estimate != (stamp, estimate.windows):
            self._estimate = stamp, estimate.windows
            yield estimate
        yield from self._notes[IDENTIFICATION].take(stamp, statuses, values=False)

    def _innovation(self, stamp: int, message: Any) -> Iterator[Shown]:
        deviations = {
            channel.channel: channel.innovation / channel.std
            for channel in read_innovations(message)
            if channel.std > 0.0
        }
        yield Innovations(stamp, deviations)

    def _findings(self, stamp: int, message: Any) -> Iterator[Shown]:
        yield from self._notes[FINDINGS].take(stamp, read_statuses(message), values=True)

    def _trial(self, stamp: int, message: Any) -> Iterator[Shown]:
        yield from self._notes[TRIAL].take(stamp, read_statuses(message), values=False)

    def _wanted_lengths(self, stamp: int, message: Any) -> Iterator[Shown]:
        lengths = zip(SIDES, read_winch_command(message), strict=True)
        values = {f'{side}_length': length for side, length in lengths if length is not None}
        yield Quantities(stamp, 'wanted', values)

    def _wanted_speed(self, stamp: int, message: Any) -> Iterator[Shown]:
        speed, _ = read_vessel_command(message)
        yield Quantities(stamp, 'wanted', {'speed_water': speed})

    def _is_due(self, topic: str, stamp: int) -> bool:
        due = self._due.get(topic)
        # A stamp far back belongs to a tow that has begun again.
        if due is not None and due - round(SLOW_S * SECOND) <= stamp < due:
            return False
        self._due[topic] = stamp + round(SLOW_S * SECOND)
        return True


def _stamp(topic: str, message: Any) -> int:
    """Stamp (ns) of a message; an array of markers has that of its first."""
    if topic != GEAR:
        return stamp_of(message)
    if not message.markers:
        raise MessageError(f'{GEAR}: no markers; expected the gear')
    return stamp_of(message.markers[0])


def _coefficients_of(stamp: int, statuses: Sequence[Status]) -> Coefficients | None:
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
    if status is None:
        return None
    flag = ' determined'
    names = [key.removesuffix(flag) for key in status.values if key.endswith(flag)]
    if not names:
        return None
    intervals = {
        name: Interval(
            read_number(status, name),
            read_number(status, f'{name} low'),
            read_number(status, f'{name} high'),
            status.values[name + flag] == 'true',
        )
        for name in names
    }
    windows = int(read_number(status, 'windows'))
    return Coefficients(stamp, windows, intervals, one_line(status.message, DIAGNOSIS.value))


class _NoteBook:
    """Filter of notes: a topic's status passes if its sentence or its values have changed."""

    def __init__(self) -> None:
        self._told: dict[str, str] = {}

    def take(self, stamp: int, statuses: Sequence[Status], *, values: bool) -> Iterator[Note]:
        """Yield a note per status with news, with its values if these are wanted.

        A status may repeat text from other programs, so each note is one line of bounded length.
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


class _SweepJoiner:
    """Joins an image and the scan of the same stamp, whichever comes first."""

    def __init__(self) -> None:
        self._half: SonarImageSample | SonarScanSample | None = None

    def take(self, half: SonarImageSample | SonarScanSample) -> Sweep | None:
        """Return the sweep that this half completes; None if the other half is missing.

        Raises
        ------
        MessageError
            If they have different numbers of beams.
        """
        other, self._half = self._half, half
        if other is None or other.stamp != half.stamp:
            return None
        for image, scan in ((half, other), (other, half)):
            if isinstance(image, SonarImageSample) and isinstance(scan, SonarScanSample):
                if len(scan.ranges) != len(image.image):
                    raise MessageError(
                        f'sonar/image: {len(image.image)} beams, and sonar/scan of the same stamp '
                        f'has {len(scan.ranges)}; expected as many'
                    )
                return Sweep(image.stamp, image, scan)
        return None


_OTHERS: dict[str, Callable[[TowReader, int, Any], Iterator[Shown]]] = {
    GEAR: TowReader._markers,
    MOUTH: TowReader._mouth,
    SECTION: TowReader._section,
    SCHOOLS: TowReader._schools,
    SEABED: TowReader._seabed,
    IDENTIFICATION: TowReader._identification,
    INNOVATION: TowReader._innovation,
    FINDINGS: TowReader._findings,
    TRIAL: TowReader._trial,
    WINCH_COMMAND: TowReader._wanted_lengths,
    VESSEL_COMMAND: TowReader._wanted_speed,
}
