"""The winches: counter, pay-out speed and load cell of both."""

from trawl_ros.instruments.instrument import Draws, Instrument
from trawl_ros.instruments.parameters import WinchParameters
from trawl_ros.instruments.samples import Sample, WinchSample
from trawl_ros.simulation.truth import SIDES, Truth, WinchTruth


class WinchInstrument(Instrument[tuple[WinchTruth, WinchTruth], WinchSample]):
    """Sees both winches, port first, and reports them in one sample."""

    def __init__(self, parameters: WinchParameters, draws: Draws) -> None:
        quantities = {
            'length': parameters.length,
            'speed': parameters.speed,
            'tension': parameters.tension,
        }
        errors = {
            f'{side}/{name}': channel.model()
            for side in SIDES
            for name, channel in quantities.items()
        }
        super().__init__('winch/joint_states', parameters.rate_hz, errors, draws)

    def _read(self, part: tuple[WinchTruth, WinchTruth], stamp: int) -> WinchSample:
        def both(quantity: str) -> tuple[float, float]:
            port, starboard = (
                self._measure(f'{side}/{quantity}', getattr(winch, quantity), stamp)
                for side, winch in zip(SIDES, part, strict=True)
            )
            return port, starboard

        return WinchSample(stamp, both('length'), both('speed'), both('tension'))


class WinchInstruments:
    """All that measures on the winches."""

    def __init__(self, parameters: WinchParameters, draws: Draws) -> None:
        self.winch = WinchInstrument(parameters, draws)

    def observe(self, truth: Truth) -> list[Sample]:
        """Give the samples that are due."""
        sample = self.winch.observe(truth.winches, truth.stamp)
        return [] if sample is None else [sample]
