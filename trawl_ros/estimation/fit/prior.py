"""Prior of the board's coefficients: start values, their std, and bounds."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.errors import GearError
from trawl_ros.records.coefficients import COEFFICIENTS


@dataclass(frozen=True)
class BoardPrior:
    """Prior of the coefficients: start, standard deviation and bounds, in the order of eq. 36.

    All four arrays have shape (12,) and no unit; ``low < high``, ``std > 0`` and the start
    lies within the bounds. ``std`` is also the scale against which sensitivities, shrink
    and condition number are measured. Where more is estimated along, ``names`` has its names behind
    those of the coefficients, and the arrays its values.

    Raises
    ------
    GearError
        If an array has the wrong length, is not finite or contradicts the others.
    """

    start: np.ndarray
    std: np.ndarray
    low: np.ndarray
    high: np.ndarray
    names: tuple[str, ...] = COEFFICIENTS

    def __post_init__(self) -> None:
        for field in ('start', 'std', 'low', 'high'):
            array = np.array(getattr(self, field), dtype=float)
            if array.shape != (len(self.names),) or not np.all(np.isfinite(array)):
                raise GearError(
                    f'identification.{field} has shape {array.shape} or values that are not '
                    f'finite; expected {len(self.names)} finite numbers'
                )
            array.flags.writeable = False
            object.__setattr__(self, field, array)
        for i, name in enumerate(self.names):
            if self.std[i] <= 0.0:
                raise GearError(
                    f'identification: the std of {name} is {self.std[i]:g}, expected more than 0'
                )
            if not self.low[i] < self.high[i]:
                raise GearError(
                    f'identification: the bounds of {name} are {self.low[i]:g} to '
                    f'{self.high[i]:g}, expected the lower one first'
                )
            if not self.low[i] <= self.start[i] <= self.high[i]:
                raise GearError(
                    f'identification: the start of {name} is {self.start[i]:g}, expected it '
                    f'within its bounds {self.low[i]:g} to {self.high[i]:g}'
                )

    def first(self, number: int) -> 'BoardPrior':
        """Prior of the first values only."""
        start, std, low, high = (own[:number] for own in self._arrays)
        return BoardPrior(start, std, low, high, self.names[:number])

    def followed_by(self, other: 'BoardPrior') -> 'BoardPrior':
        """Prior with the values of another appended."""
        pairs = zip(self._arrays, other._arrays, strict=True)
        start, std, low, high = (np.concatenate(pair) for pair in pairs)
        return BoardPrior(start, std, low, high, (*self.names, *other.names))

    @property
    def _arrays(self) -> tuple[np.ndarray, ...]:
        return self.start, self.std, self.low, self.high
