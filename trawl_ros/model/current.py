"""Current of the water at a height, as compiled loops take it."""

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.compiled import compiled, inner


@inner
def current_at(
    knots: FloatArray, cubics: FloatArray, z: float, flow: FloatArray, slope: FloatArray
) -> None:
    """Current (3,) at one height and its derivative by height, from `Water.profile`."""
    depth, place = -z.real, 0
    inside = knots[0] < depth < knots[-1]
    while place + 1 < len(knots) and knots[place + 1] <= depth:
        place += 1
    along = depth - knots[place] if inside else 0.0
    for axis in range(2):
        c3, c2 = cubics[place, axis, 0], cubics[place, axis, 1]
        c1, c0 = cubics[place, axis, 2], cubics[place, axis, 3]
        slope[axis] = -((3.0 * c3 * along + 2.0 * c2) * along + c1) if inside else 0.0
        flow[axis] = ((c3 * along + c2) * along + c1) * along + c0 + slope[axis] * (z - z.real)
    flow[2] = slope[2] = 0.0


@compiled
def fill_currents(
    knots: FloatArray, cubics: FloatArray, z: FloatArray, flow: FloatArray, slope: FloatArray
) -> None:
    """Currents (n, 3) at heights (n,) and their derivatives by height."""
    for n in range(len(z)):
        current_at(knots, cubics, z[n], flow[n], slope[n])
