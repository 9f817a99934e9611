"""Cost of one factorisation of the gear's stiffness matrix."""

from trawl_ros.benchmark.timing import median_s
from trawl_ros.model.assembly import linearised
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.factor import factorised

NUMBER_BYTES = 12
"""Of one number in the factors: 8 for itself and 4 for its row."""


def factor_cost(model: GearModel, state: State, tow: Tow, repeats: int) -> tuple[float, float]:
    """CPU time (s) of one factorisation with its solution, and memory (MB) of the factors."""
    here = linearised(model, state, tow)
    factor = factorised(model.pattern, here.stiffness)
    seconds = median_s(lambda: factorised(model.pattern, here.stiffness).solve(here.force), repeats)
    return seconds, factor.fill * NUMBER_BYTES / 1e6
