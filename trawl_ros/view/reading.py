"""Records to be shown, from the messages of a tow in the order in which they come."""

import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from typing_extensions import assert_never

from trawl_ros.core.errors import MessageError
from trawl_ros.core.time import SECOND
from trawl_ros.gear.records import GearRecord
from trawl_ros.messages.commands import read_vessel_command, read_winch_command
from trawl_ros.messages.diagnostics import read_statuses
from trawl_ros.messages.estimates import INNOVATION, read_innovations
from trawl_ros.messages.from_messages import SAMPLE_TOPICS, to_sample
from trawl_ros.messages.pieces import read_vector
from trawl_ros.messages.point_clouds import read_point_cloud
from trawl_ros.messages.stamps import stamp_of
from trawl_ros.messages.truth_from_messages import schools_truth, seabed_truth
from trawl_ros.model.water import build_water
from trawl_ros.plots.moments import GEAR, MOUTH, SECTION
from trawl_ros.plots.reading import TRUTH, sample_columns
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
    Echoes,
    Innovations,
    Quantities,
    Schools,
    Section,
    SeenSchools,
    Shown,
)
from trawl_ros.view.ship import ShipFollower
from trawl_ros.view.statuses import NoteBook, coefficients_of
from trawl_ros.view.sweeps import SweepJoiner

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
"""Topics whose stamps are those of windows, which are thought about while the tow goes on."""

FAR_BACK_S = 120.0
"""Stamps further back than this are those of a tow that has begun anew."""

SLOW_S = 1.0
"""Schools and the sonar's section are shown this often, however often truth comes."""


class TowReader:
    """Reader of the messages of a tow.

    Parameters
    ----------
    gear
        Its water turns pressure into depth, and its sizes draw the gear where markers do not.
    apart_s
        Between two shapes of the gear.
    model
        True to have beside the readings what the gear's model says in steady windows.
    """

    def __init__(self, gear: GearRecord, apart_s: float = 1.0, *, model: bool = False) -> None:
        self._depth_at = build_water(gear).depth
        self._ship = ShipFollower()
        self._gear = GearFollower(gear, self._ship, apart_s)
        self._model = ModelFollower(gear) if model else None
        self._newest: int | None = None
        self._due: dict[str, int] = {}
        self._sweeps = SweepJoiner()
        self._notes = {topic: NoteBook() for topic in (IDENTIFICATION, FINDINGS, TRIAL)}
        self._estimate: tuple[int, int] | None = None
        self._doors: dict[str, tuple[int, Any]] = {}
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
        """Yield what the model says, where it is asked, of a message that is not shown itself.

        Raises
        ------
        MessageError
            If it contradicts its topic.
        """
        if self._model is not None and topic in SAMPLE_TOPICS:
            yield from self._model.take(to_sample(topic, message))

    def finish(self) -> Iterator[Shown]:
        """Yield the records that waited for more messages; no more come."""
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
        columns = sample_columns(sample, self._depth_at)
        if columns:
            yield from self._quantities(Quantities(sample.stamp, 'measured', columns))
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
        columns = TRUTH[topic](topic, message)
        if topic == VESSEL:
            position = read_vector(message.pose.pose.position)
            yield self._ship.truth(stamp, position, columns['heading'])
        if topic.startswith('truth/door/'):
            side = topic.split('/')[2]
            self._doors[side] = stamp, read_vector(message.pose.pose.position)
            columns |= self._spread(stamp)
        self._headrope_depth = columns.get('net_depth', self._headrope_depth)
        yield from self._quantities(Quantities(stamp, 'truth', columns))

    def _spread(self, stamp: int) -> dict[str, float]:
        """Distance of the doors once both are known at a stamp."""
        places = [place for at, place in self._doors.values() if at == stamp]
        if len(places) < len(SIDES):
            return {}
        return {'door_spread': float(np.linalg.norm(places[0] - places[1]))}

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
        estimate = coefficients_of(stamp, statuses)
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
        # A stamp far back is that of a tow that has begun anew.
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
