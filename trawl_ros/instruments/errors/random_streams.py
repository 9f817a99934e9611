"""Random generators: one of its own for each name, all from one seed."""

import zlib

import numpy as np


def generator(seed: int, name: str, number: int = 0) -> np.random.Generator:
    """Return the generator of a seed and a name, and of one number among several under it."""
    key = zlib.crc32(name.encode())
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(key, number)))
