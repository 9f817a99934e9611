"""Where random numbers come from: a generator of its own for each name, all from one seed."""

import zlib

import numpy as np


def generator(seed: int, name: str, number: int = 0) -> np.random.Generator:
    """Give the generator that belongs to a seed and a name, and to one of several under it."""
    key = zlib.crc32(name.encode())
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(key, number)))
