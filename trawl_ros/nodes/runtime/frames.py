# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Parameters of a node for the names of its frames."""

from trawl_ros.nodes.runtime.parameters import Flag, ParameterError, Parameters, Spec, Text
from trawl_ros.records.frames import FRAME_SENTENCES, frame_names, frames_of
from trawl_ros.records.topics import ODOM, TOPICS, TRANSFORMS

_TRANSFORMS: tuple[Spec, ...] = (
    Flag('publish_tf', True, "Whether to publish the ship's pose on /tf, where tf2_msgs is "
         'installed; false where an estimator of poses does.'),
    Text('odom_frame', '', 'Frame between map and the ship on /tf, as in REP-105; without one the '
         'ship is in map.'),
)  # fmt: skip


def frame_specs(node: str) -> tuple[Spec, ...]:
    """Return the parameters of a node for its frames.

    Every node has the prefix, so that one file of parameters does for all nodes of a ship.
    """
    frames = frames_of(node, TOPICS.values())
    return (
        Text('frame_prefix', '', 'Put before the names of all frames but that of map, as ship_a/.'),
        *(
            Text(f'{frame}_frame', frame, f'Name of frame {frame}: {FRAME_SENTENCES[frame]}.',
                 needed=True)
            for frame in frames
        ),
        *(_TRANSFORMS if frames and node in TRANSFORMS.published_by else ()),
    )  # fmt: skip


def published_names(node: str, given: Parameters) -> dict[str, str]:
    """Return the published name of each frame that has another one than its own.

    Raises
    ------
    ParameterError
        If two frames have one name.
    """
    frames = frames_of(node, TOPICS.values())
    names = {frame: given[f'{frame}_frame'] for frame in frames}
    if frames and node in TRANSFORMS.published_by and given['odom_frame']:
        names[ODOM] = given['odom_frame']
    if len(set(names.values())) < len(names):
        listed = ', '.join(f'{frame}_frame {name}' for frame, name in names.items())
        raise ParameterError(f'parameters {listed}: expected a name of its own for each')
    return frame_names(names, given['frame_prefix'])
