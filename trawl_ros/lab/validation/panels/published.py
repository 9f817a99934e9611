# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Published panels as records: sources, drag and lift by angle, from ``config/panels``."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.resources import share_path
from trawl_ros.core.schema import Record, load_yaml, validated
from trawl_ros.gear.netting import SectionRecord

FILE = ('config', 'panels', 'published.yaml')

Angle = Annotated[float, Field(ge=0, le=90)]
Solidity = Annotated[float, Field(gt=0, lt=0.5)]


class PanelSource(Record):
    """Source of panels: title, address, and how it was read."""

    title: str
    address: str
    read: Literal['source', 'abstract', 'code', 'review']


class PanelRecord(Record):
    """Panel of netting: coefficients of drag and lift on an ``area`` by angle to the flow.

    ``across`` has them over the drag of the same panel across the flow. Meshes lie square to the
    flow, or are diamonds as wide as long.
    """

    name: str
    source: str
    use: Literal['counts', 'shown']
    why: str = ''
    solidity: Solidity
    twine_mm: Annotated[float, Field(gt=0, le=20)]
    knots: Literal['knotted', 'knotless']
    meshes: Literal['square', 'diamond']
    speed_m_s: Annotated[float, Field(gt=0, le=5)]
    area: Literal['outline', 'twine', 'across']
    angle_deg: Annotated[tuple[Angle, ...], Field(min_length=1)]
    drag: tuple[float, ...]
    lift: tuple[float, ...] = ()

    @model_validator(mode='after')
    def _alike(self) -> 'PanelRecord':
        for name in ('drag', 'lift'):
            values = getattr(self, name)
            if len(values) not in ({0} if name == 'lift' else set()) | {len(self.angle_deg)}:
                raise ValueError(
                    f'{name}: found {len(values)} values, expected {len(self.angle_deg)}, one for '
                    'each of angle_deg'
                )
        if self.use == 'shown' and not self.why:
            raise ValueError('why: missing, expected why it does not count')
        return self

    @property
    def section(self) -> SectionRecord:
        """Section of netting like the panel's."""
        return netting_of(
            self.solidity, 1e-3 * self.twine_mm, self.knots == 'knotless', self.meshes == 'square'
        )


class KnotRecord(Record):
    """Drag of knotted netting over that of knotless netting, minus one, at an angle."""

    name: str
    source: str
    solidity: Solidity
    angle_deg: Angle
    more: Annotated[float, Field(gt=0)]


class UnusedPanel(Record):
    """Source that was examined and not used, with the reason."""

    source: str
    why: str


class PublishedPanels(Record):
    """All published panels: sources by name, panels, effect of knots, and unused sources."""

    sources: dict[str, PanelSource]
    panels: Annotated[tuple[PanelRecord, ...], Field(min_length=1)]
    knots: tuple[KnotRecord, ...]
    not_used: tuple[UnusedPanel, ...]

    @model_validator(mode='after')
    def _named(self) -> 'PublishedPanels':
        named = {one.source for one in self.panels} | {one.source for one in self.knots}
        if named - set(self.sources):
            raise ValueError(
                f'sources: found none named {", ".join(sorted(named - set(self.sources)))}'
            )
        return self


def netting_of(solidity: float, diameter: float, knotless: bool, square: bool) -> SectionRecord:
    """Netting of a solidity and a twine (m), with diamonds as wide as long or square meshes."""
    return SectionRecord(
        name='panel',
        length_m=1.0,
        front_circumference_m=1.0,
        back_circumference_m=1.0,
        mesh_m=4.0 * diameter / solidity,
        twine_diameter_m=diameter,
        twine_density_kg_m3=1140.0,
        twine_modulus_pa=2.0e9,
        knotless=knotless,
        square=square,
    )


def published_panels() -> PublishedPanels:
    """Read the panels that come with the package.

    Raises
    ------
    TrawlError
        Naming file, key, what was found and what was expected.
    """
    path = share_path(*FILE)
    return validated(PublishedPanels, load_yaml(path, TrawlError), path, TrawlError)
