# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Sensors that only measure observables of the gear, all built from their rows."""

from collections.abc import Iterable

from trawl_ros.instruments.errors.instrument import Instrument, SeedPlan
from trawl_ros.instruments.parameters import GROUPS, ByUnit, InstrumentParameters, observing
from trawl_ros.records.observables import Observables
from trawl_ros.records.registry import Sensor, changed, with_numbers
from trawl_ros.records.samples import Sample


class ObservingInstrument(Instrument[Observables, Sample]):
    """Sensor of observables; it observes all of them and reports those of its channels."""

    def __init__(self, row: Sensor[Sample], parameters: ByUnit, draws: SeedPlan) -> None:
        errors = {field.name: parameters.model() for field in row.fields}
        super().__init__(row.name, parameters.timing(), errors, draws)
        self._row = row

    def _read(self, part: Observables, stamp: int) -> Sample:
        numbers = {
            field: self._measure(field.name, float(getattr(part, field.channel.name)), stamp)
            for field in self._row.fields
            if field.channel
        }
        sample = with_numbers(changed(self._row.blank, stamp=stamp), numbers)
        if self._row.states_noise:
            sample = changed(sample, std=self._stated_std(self._row.fields[0].name))
        return sample


class ObservingInstruments:
    """Sensors of some nodes that only measure observables.

    Parameters
    ----------
    parameters
        Parameters of all instruments; a sensor without parameters is not aboard.
    draws
        Seed and changes of state.
    nodes
        Names of the nodes.
    """

    def __init__(
        self, parameters: InstrumentParameters, draws: SeedPlan, nodes: Iterable[str] = GROUPS
    ) -> None:
        self.instruments = tuple(
            ObservingInstrument(row, errors, draws)
            for node in nodes
            for row in observing(node)
            if (errors := getattr(getattr(parameters, GROUPS[node]), row.errors))
        )

    def observe(self, observables: Observables | None, stamp: int) -> list[Sample]:
        """Return the samples that are due at a stamp (ns)."""
        if observables is None:
            return []
        return [one for sensor in self.instruments for one in sensor.observe(observables, stamp)]
