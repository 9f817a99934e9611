# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Right answers to blind trials: leaves of the library for each hidden cause, fixed beforehand."""

from collections.abc import Mapping

from trawl_ros.diagnosis.library.table import hypothesis_table
from trawl_ros.lab.trials.hidden_effects.inside import INSIDE, Draw
from trawl_ros.lab.trials.hidden_effects.other_keys import CAUSES, RIGHT_CHANGES, RIGHT_NAMES
from trawl_ros.lab.trials.hidden_effects.outside import OUTSIDE

EVERY_CAUSE: Mapping[str, Draw] = {**INSIDE, **OUTSIDE, **CAUSES}
"""All causes that can be hidden, by name."""

NOT_IN_LIBRARY = ('block_angle', 'opening_by_depth')
"""Hidden causes that no hypothesis of the library is."""

LEAVES_OF_OUTSIDE: Mapping[str, tuple[str, ...]] = {
    'bridle_weed': (
        'starboard_bridle_diameter',
        'starboard_bridle_friction',
        'bridles_drag_one_side',
    ),
    'counter_drift': ('counters_drift',),
    'jet': ('current_profile_along',),
    'net_weight': ('net_weight',),
    'pitch_mount': ('both_pitch_drift',),
    'port_depth_sensor': ('port_door_depth_scale', 'port_door_depth_offset'),
    'spread_by_hours': ('spread_drift',),
    'starboard_cell': ('starboard_cell_scale', 'starboard_cell_offset'),
}
"""Leaves of causes that the catalogue of effects does not have."""

SAME_IN_ANOTHER_FORM: Mapping[str, tuple[str, ...]] = {
    'current_shear': ('current_profile_along',),
    'cross_current': ('current_profile_across',),
    # The log's error and the edge of a current follow the heading; a tide does not.
    'edge_of_current': ('log_drift',),
    'catch_build_up': ('catch',),
    'board_mass': ('board_weight',),
    'kite_gone': ('kite_setting',),
    'floats_gone': ('float_buoyancy',),
    'thicker_warps': ('warp_diameter',),
}
"""Leaves that are the same thing in another form."""


def right_leaves(cause: str) -> tuple[str, ...]:
    """Return the leaves of the library that a hidden cause is; none if it is outside of it."""
    if cause in NOT_IN_LIBRARY:
        return ()
    if cause in LEAVES_OF_OUTSIDE:
        return LEAVES_OF_OUTSIDE[cause]
    effects = (cause,) if cause in INSIDE else RIGHT_NAMES[cause]
    leaves = [
        row.name
        for row in hypothesis_table().entries
        if not row.keys and (row.effect or row.name) in effects
    ]
    return tuple(
        dict.fromkeys(
            (*leaves, *RIGHT_CHANGES.get(cause, ()), *SAME_IN_ANOTHER_FORM.get(cause, ()))
        )
    )


def right_nodes(cause: str) -> tuple[str, ...]:
    """Return the nodes, each with one check on deck, of the leaves that a hidden cause is."""
    table = {row.name: row.at for row in hypothesis_table().entries}
    sides = ('port', 'starboard')
    at = {f'{side}_{name}': node for name, node in table.items() for side in sides} | table
    return tuple(dict.fromkeys(at[leaf] for leaf in right_leaves(cause)))


SIZED_AS_HIDDEN = ('board_area', 'footrope_weight', 'headrope_length', 'kite_weight', 'front_twine',
                   'board_mass', 'warp_diameter', 'twine', 'warp_hole_ahead')  # fmt: skip
"""Changes of the gear file that are hidden in this very form, so that sizes can be compared."""


def right_sizes(cause: str, size: float) -> Mapping[str, float]:
    """Return the true value of each right leaf whose size has the unit of the hidden one."""
    # The factor of strumming is neutral at 1; all other sizes are neutral at 0.
    return {
        leaf: size + (1.0 if leaf == 'warp_strumming' else 0.0)
        for leaf in right_leaves(cause)
        if leaf == cause or leaf in SIZED_AS_HIDDEN
    }
