# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Readings that the gear model predicts in the steady windows of a tow."""

from collections.abc import Iterable, Iterator
from contextlib import suppress

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.estimation.from_gear import finder_for, predictor_for
from trawl_ros.estimation.windows.records import RejectedWindow, SteadyWindow, WindowOptions
from trawl_ros.gear.records import GearRecord
from trawl_ros.plots.records import Quantities
from trawl_ros.records.channels import INPUTS
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.records.samples import Sample
from trawl_ros.solver.equilibrium import Equilibrium
from trawl_ros.solver.predict import Prediction
from trawl_ros.view.records import Note

MAX_WINDOWS_PER_STATE = 1_000_000
"""No limit in practice: an estimate needs two windows of a steady state, a view shows all."""

NAMES = {'vertical_opening': 'opening_height'}
"""Observables with another name in `plots.records.TowHistory`, and that name."""


class ModelFollower:
    """Steady states of a gear at the warp lengths and speeds of a tow.

    Between steady windows the gear is in motion, and the model predicts nothing.

    Parameters
    ----------
    gear
        The gear as its file has it, with its effects.
    """

    def __init__(self, gear: GearRecord) -> None:
        self._finder = finder_for(gear, WindowOptions(max_windows_per_state=MAX_WINDOWS_PER_STATE))
        self._predictor = predictor_for(gear)
        self._name = gear.name
        self._last: Equilibrium | None = None
        self._newest = 0
        self._drawn = 0

    def take(self, sample: Sample) -> Iterator[Quantities | Note]:
        """Yield the predictions for the windows that a sample completes."""
        self._newest = max(self._newest, sample.stamp)
        yield from self._shown(self._finder.feed(sample))

    def finish(self) -> Iterator[Quantities | Note]:
        """Yield the predictions for the last windows; no more samples follow."""
        yield from self._shown(self._finder.finish())
        if not self._drawn:
            reasons = self._finder.rejections.sentences
            counts = '; '.join(f'{reason}: {sentence}' for reason, sentence in reasons.items())
            missing = counts or 'not all of the channels came that a steady window needs'
            text = f'{self._name} as modelled is not drawn: no steady window with a steady state '
            yield Note(self._newest, 'view', 'WARN', f'{text}({missing})')

    def _shown(
        self, decided: Iterable[SteadyWindow | RejectedWindow]
    ) -> Iterator[Quantities | Note]:
        for window in decided:
            if not isinstance(window, SteadyWindow):
                continue
            try:
                prediction = self._predicted(window)
                if prediction.state.surfaced:
                    highest = f'{prediction.state.highest:.1f} m'
                    raise NoSteadyState(f'the gear breaks the surface by {highest}')
            except NoSteadyState as reason:
                self._finder.rejections.add('no steady state', str(reason))
                yield Note(window.start_ns, 'view', 'WARN', f'{self._name} as modelled: {reason}')
                continue
            self._last = prediction.state
            self._drawn += 1
            values = dict(zip(OBSERVABLES, map(float, prediction.values), strict=True))
            named = {NAMES.get(name, name): value for name, value in values.items()}
            yield Quantities(window.start_ns, 'model', named)
            yield Quantities(window.end_ns - 1, 'model', named)
            # The line ends here: what comes next is another window.
            yield Quantities(window.end_ns, 'model', dict.fromkeys(named, float('nan')))

    def _predicted(self, window: SteadyWindow) -> Prediction:
        predictor = self._predictor.in_window(window)
        port, starboard, speed = (window.means[name] for name in INPUTS)
        coefficients = predictor.model.coefficients
        if self._last is not None:
            # A nearby state may lead astray where a cold start finds one.
            with suppress(NoSteadyState):
                return predictor.predict(coefficients, port, starboard, speed, self._last)
        return predictor.predict(coefficients, port, starboard, speed)
