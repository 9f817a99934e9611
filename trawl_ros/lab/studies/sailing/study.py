"""Study of sailed trials: random boards, each towed on courses of the same hours."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
from trawl_ros.estimation.planning.plan import plan_for
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.studies.identification.plant import TOWS, Cut
from trawl_ros.lab.studies.sailing.courses import (
    Course,
    Sea,
    known_course,
    planned_course,
    sailed_course,
)
from trawl_ros.solver.trimming.drawn_board import draw_board, fastened_as

SEED = 2100


@dataclass(frozen=True)
class SailingPlan:
    """Plan: gear, meshes around its net, hours of each course, number of boards, and the seed."""

    gear: str = 'kaifuha'
    around: int = 12
    hours: float = 6.0
    boards: int = 10
    seed: int = SEED


@dataclass(frozen=True)
class SailedBoard:
    """Board, towed on each course: sailed by itself, as planned beforehand, in a sweep, and as it
    would be planned if the board were known.
    """

    number: int
    coefficients: list[float]
    sailed: Course
    planned: Course
    sweep: Course
    known: Course

    @property
    def known_over_plan(self) -> float:
        """Mean std as planned with the board known over that as planned."""
        return self.known.mean_std / self.planned.mean_std

    @property
    def over_plan(self) -> float:
        """Mean std when sailed over that as planned."""
        return self.sailed.mean_std / self.planned.mean_std

    @property
    def over_sweep(self) -> float:
        """Mean std when sailed over that of the sweep."""
        return self.sailed.mean_std / self.sweep.mean_std


def run_sailing(plan: SailingPlan, on_progress: OnProgress = ignore) -> list[SailedBoard]:
    """Tow each board on its courses.

    Each is planned with the coefficients as identification starts, fastened as it is; readings err
    alike on all courses, and the plant is the model.
    """
    unrigged = Cut(plan.around).model(plan.gear)
    boards = []
    for number in range(plan.boards):
        drawn = draw_board(unrigged, TOWS[0], np.random.default_rng([plan.seed, number]))
        gear = fastened_as(unrigged, drawn.gear)
        trial = plan_for(gear, hours=plan.hours, on_progress=on_progress)

        def on_state(text: str, number: int = number) -> None:
            on_progress(WorkProgress('boards', number, plan.boards, 'boards', text))

        def sea(plant: GearRecord = drawn.gear, number: int = number) -> Sea:
            return Sea(plant, (plan.seed, number, 1))

        boards.append(
            SailedBoard(
                number,
                drawn.coefficients.tolist(),
                sailed_course(sea(), gear, plan.hours, on_state),
                planned_course(sea(), gear, trial.trial.legs),
                planned_course(sea(), gear, trial.sweeps[0].legs),
                known_course(sea(), gear, drawn.coefficients, plan.hours),
            )
        )
    return boards
