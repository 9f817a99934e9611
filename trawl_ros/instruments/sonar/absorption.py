# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Absorption of sound in sea water."""

import numpy as np

SEA_PH = 8.0
"""Acidity of sea water; it matters only below some kilohertz."""


def absorption(frequency: float, temperature: float, salinity: float, depth: float) -> float:
    """Return the absorption coefficient of sound in sea water.

    It is the simplified formula of Ainslie and McColm, J. Acoust. Soc. Am. 103(3), 1998, within
    10 % of that of Francois and Garrison (1982).

    Parameters
    ----------
    frequency
        Frequency, Hz, up to 1 MHz.
    temperature, salinity, depth
        State of the water, °C, g/kg and m.

    Returns
    -------
    float
        Absorption, dB/m.
    """
    f, z = frequency / 1e3, depth / 1e3
    boric = 0.78 * np.sqrt(salinity / 35) * np.exp(temperature / 26)
    magnesium = 42 * np.exp(temperature / 17)
    per_km = (
        0.106 * boric * f**2 / (boric**2 + f**2) * np.exp((SEA_PH - 8) / 0.56)
        + 0.52
        * (1 + temperature / 43)
        * (salinity / 35)
        * magnesium
        * f**2
        / (magnesium**2 + f**2)
        * np.exp(-z / 6)
        + 0.00049 * f**2 * np.exp(-(temperature / 27 + z / 17))
    )
    return float(per_km / 1e3)
