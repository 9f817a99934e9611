# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Messages that a trial records: truth and the readings of its instruments."""

from collections.abc import Iterator

from trawl_ros.core.time import SECOND
from trawl_ros.instruments.suite import InstrumentSuite
from trawl_ros.messages.markers import gear_markers
from trawl_ros.messages.pieces import TopicMessage
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.messages.transforms import mounts_message, transforms_message
from trawl_ros.messages.truth_to_messages import truth_messages
from trawl_ros.records.frames import DOOR_MOUNTS, WIDTH_MOUNT, echo_sounder_mount
from trawl_ros.records.topics import PICTURES
from trawl_ros.scenario.run import Trial


def recorded_messages(trial: Trial) -> Iterator[tuple[int, list[TopicMessage]]]:
    """Tow a trial to its end and yield each stamp (ns) with all recorded messages."""
    scenario = trial.scenario
    suite = InstrumentSuite(
        scenario.instruments,
        surroundings=scenario.surroundings,
        draws=scenario.draws,
        faults=scenario.faults,
    )
    sensor_effects = scenario.sensor_effects()
    while (truth := trial.step()) is not None:
        messages: list[TopicMessage] = []
        if 'truth' in scenario.record.record:
            messages += truth_messages(truth)
            if truth.stamp % SECOND == 0:
                messages.append(gear_markers(trial.simulation.picture()))
        if 'transforms' in scenario.record.record:
            if truth.stamp == 0:
                sounder = echo_sounder_mount(scenario.instruments.vessel.draught_m)
                messages.append(mounts_message(0, (sounder, *DOOR_MOUNTS, WIDTH_MOUNT)))
            messages.append(transforms_message(truth))
        for topic, message in map(sample_message, map(sensor_effects, suite.observe(truth))):
            if ('pictures' if topic in PICTURES else 'instruments') in scenario.record.record:
                messages.append((topic, message))
        yield truth.stamp, messages
