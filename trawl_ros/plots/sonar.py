# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Figure of a trawl sonar's sweep as on its screen, with the opening read from it."""

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from trawl_ros.plots.records import SonarPicture
from trawl_ros.records.samples import SonarImageSample, SonarScanSample
from trawl_ros.report import style

PIXELS = 480
"""Width and height of the picture of a sweep, for any number of beams and cells."""

READING, TRUTH = '#4dd2ff', '#f2f2f2'
BACKGROUND, ECHOES = '#101418', 'inferno'


def sonar_figure(picture: SonarPicture, name: str) -> Figure:
    """Draw a sweep in the mouth's plane, seen looking ahead: port left, down below."""
    figure = Figure(figsize=(7.4, 7.4), layout='constrained')
    axes = figure.subplots()
    prepare(axes, picture)
    draw_sonar(axes, picture)
    axes.set_title(f'{name}, sweep from {style.clock(picture.time)} on', parse_math=False)
    handles, labels = axes.get_legend_handles_labels()
    if handles:
        figure.legend(
            handles, labels, loc='outside lower center', ncols=2, fontsize='small',
            facecolor=BACKGROUND, framealpha=1.0, labelcolor='white',
        )  # fmt: skip
    return figure


def prepare(axes: Axes, picture: SonarPicture) -> None:
    """Draw labels, limits and rings of equal range."""
    reach = picture.scan.max_range
    axes.set_facecolor(BACKGROUND)
    axes.set_aspect('equal', adjustable='box')
    axes.set_xlim(reach, -reach)
    axes.set_ylim(-reach, reach)
    axes.set_xlabel('to port / m')
    axes.set_ylabel('above the headrope / m')
    turn = np.linspace(0.0, 2.0 * np.pi, 181)
    rings = [ring for ring in axes.get_xticks() if 0.0 < ring <= reach]
    for ring in rings:
        axes.plot(
            ring * np.sin(turn), ring * np.cos(turn), color='white', alpha=0.18, linewidth=0.6
        )


def draw_sonar(axes: Axes, picture: SonarPicture) -> list[Artist]:
    """Draw echoes, reading and truth."""
    reach = picture.scan.max_range
    drawn: list[Artist] = [
        axes.imshow(
            seen(picture.image, picture.scan, PIXELS),
            extent=(reach, -reach, -reach, reach),
            cmap=ECHOES,
            vmin=0,
            vmax=255,
            zorder=0,
            interpolation='nearest',
        )
    ]
    if len(picture.mouth):
        down, port = np.vstack([picture.mouth, picture.mouth[:1]]).T
        drawn += axes.plot(
            port,
            -down,
            '-' if picture.closed else 'o',
            color=TRUTH,
            linewidth=0.8,
            markersize=2.4,
            fillstyle='none',
            markeredgewidth=0.6,
            label='truth: the mouth' if picture.closed else 'truth: ropes in this plane',
        )
    return drawn + _dimensions(axes, picture.height, picture.width)


def _dimensions(axes: Axes, height: float, width: float) -> list[Artist]:
    """Draw height and width as arrows of their length."""
    middle = -0.5 * height if np.isfinite(height) else 0.0
    arrows = (
        (height, (0.0, 0.0), (0.0, -height), 'height'),
        (width, (0.5 * width, middle), (-0.5 * width, middle), 'width'),
    )
    drawn: list[Artist] = []
    for size, begin, end, name in arrows:
        if np.isfinite(size):
            ends = np.array([begin, end]).T
            drawn += axes.plot(*ends, color=READING, lw=1.3, label=f'{name} read off: {size:.1f} m')
            style_of = {'arrowstyle': '<|-|>', 'color': READING, 'shrinkA': 0, 'shrinkB': 0}
            drawn.append(axes.annotate('', begin, end, arrowprops=style_of))
    return drawn


def seen(
    image: SonarImageSample, scan: SonarScanSample, pixels: int
) -> np.ma.MaskedArray[tuple[int, ...], np.dtype[np.uint8]]:
    """Lay a sweep out in its plane.

    Parameters
    ----------
    image, scan
        The sweep, and at which angles its beams look.
    pixels
        Of the picture in either direction.

    Returns
    -------
    masked array
        Echoes (pixels, pixels), the first row on top and the first column farthest to port,
        masked where no beam looks: each pixel has the beam and cell that its middle lies in.
    """
    beams, cells = image.image.shape
    middle = (np.arange(pixels) + 0.5) / pixels * 2.0 - 1.0
    port, down = np.meshgrid(-middle, middle)
    distance = np.hypot(port, down)
    # Beams are as wide as they lie apart, so the first one begins half of that before its angle.
    turned = np.arctan2(port, down) - scan.angle_min
    places = turned / scan.angle_increment + 0.5
    full = 2.0 * np.pi / abs(scan.angle_increment)
    beam = np.floor(np.mod(places, full)).astype(int)
    cell = np.floor(distance * cells).astype(int)
    outside = (beam >= beams) | (cell >= cells)
    echoes = image.image[np.minimum(beam, beams - 1), np.minimum(cell, cells - 1)]
    return np.ma.masked_array(echoes, mask=outside)
