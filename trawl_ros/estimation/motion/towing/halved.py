"""Steps of a tow that are halved, at one point of its gear and at the next.

Which steps are too long changes from point to point, and means change with it, by as much as their
noise: a cost that jumps so has no place of rest. What was halved at one point is at the next.
"""

from trawl_ros.solver.motion.tow import HalvedSteps

TowHalved = dict[float, HalvedSteps]
"""Steps of a tow that are halved, by when (s) the motion that takes them began."""


def copied(halved: TowHalved) -> TowHalved:
    """Copy, to which another point may add its own."""
    return {begin: set(steps) for begin, steps in halved.items()}
