# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Sparsity pattern of a gear's matrices, built once with its model."""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
import scipy.sparse as sp

from trawl_ros.core.arrays import BoolArray, FloatArray, IntArray
from trawl_ros.model.compiled import compiled, njit_fastmath

CACHED_PATTERNS = 4
"""Number of patterns kept; gears that differ only in the properties of bars share one."""


@dataclass(frozen=True, eq=False)
class SparsityPattern:
    """Sparsity pattern: slots of the blocks of bars, boards, nodes and kite in a (dof, dof) matrix.

    Attributes
    ----------
    dof
        Number of degrees of freedom.
    plain, hung, rigged
        Numbers of the bars between two nodes, from a towing block to a node, and from a fastening
        point to a node.
    rig_board, rig_point
        Board and fastening point (warp, upper, lower bridle) at which rigged bars start.
    slot
        Index in the data of each value of all blocks.
    indices, indptr
        Row indices and column pointers of the compressed sparse columns.
    """

    dof: int
    plain: IntArray
    hung: IntArray
    rigged: IntArray
    rig_board: IntArray
    rig_point: IntArray
    slot: IntArray
    indices: IntArray
    indptr: IntArray

    def matrix(self, data: FloatArray) -> sp.csc_matrix:
        """Return the sparse matrix of ``data`` on this pattern."""
        return sp.csc_matrix((data, self.indices, self.indptr), shape=(self.dof, self.dof))

    def held(self, data: FloatArray, free: BoolArray) -> FloatArray:
        """Return data with rows and columns of the identity for all but ``free`` (dof,)."""
        columns = np.repeat(np.arange(self.dof), np.diff(self.indptr))
        kept = np.where(free[self.indices] & free[columns], data, 0.0)
        return np.where((self.indices == columns) & ~free[columns], 1.0, kept)

    @cached_property
    def order(self) -> IntArray:
        """Numbers of all bars that have a block: plain, hung, rigged."""
        return np.concatenate([self.plain, self.hung, self.rigged])

    @cached_property
    def node_slots(self) -> IntArray:
        """Slots (n, 3, 3) of the diagonal blocks of nodes, by row and column."""
        nodes = (self.dof - 12) // 3
        before = 36 * len(self.plain) + 9 * len(self.hung) + 81 * len(self.rigged) + 2 * 36
        return self.slot[before : before + 9 * nodes].reshape(nodes, 3, 3)

    def blocks(self, rows: IntArray, columns: IntArray) -> IntArray:
        """Return slots (..., 3, 3) of the blocks of nodes in these rows and columns."""
        three = np.arange(3)
        down = 3 * rows[..., None, None] + three[:, None]
        across = 3 * columns[..., None, None] + three
        wanted = across.astype(np.int64) * self.dof + down
        column = np.repeat(np.arange(self.dof, dtype=np.int64), np.diff(self.indptr))
        return np.searchsorted(column * self.dof + self.indices, wanted)

    def times(self, data: FloatArray, vector: FloatArray) -> FloatArray:
        """Return the product of the matrix of ``data`` with a vector (dof,)."""
        product = np.zeros(self.dof, np.result_type(data, vector))
        _multiply(self.indices.view(np.uint32), self.indptr, data, vector, product)
        return product

    def add(self, blocks: list[FloatArray], data: FloatArray) -> None:
        """Add the blocks of hung and rigged bars, boards, nodes and kite, in this order.

        The data on the pattern has the blocks of plain bars already.
        """
        first = 36 * len(self.plain)
        for block in blocks:
            values = block.ravel()
            _add(values, self.slot[first : first + len(values)], data)
            first += len(values)


@njit_fastmath
def _multiply(
    indices: IntArray,
    indptr: IntArray,
    data: FloatArray,
    vector: FloatArray,
    product: FloatArray,
) -> None:
    # The three columns of a node have the same rows.
    for column in range(0, len(vector), 3):
        first, second, third = indptr[column], indptr[column + 1], indptr[column + 2]
        a, b, c = vector[column], vector[column + 1], vector[column + 2]
        for k in range(second - first):
            product[indices[first + k]] += (
                data[first + k] * a + data[second + k] * b + data[third + k] * c
            )


@compiled
def _add(values: FloatArray, slots: IntArray, data: FloatArray) -> None:
    for k in range(len(values)):
        data[slots[k]] += values[k]


def build_pattern(nodes: int, ends: IntArray, kite: IntArray) -> SparsityPattern:
    """Return the pattern of a gear; gears with equal arguments get the same object.

    Parameters
    ----------
    nodes
        Number of free nodes.
    ends
        Points (m, 2) between which the bars lie.
    kite
        The three nodes that carry the kite.
    """
    return _built(nodes, _Numbers(ends), _Numbers(kite))


class _Numbers:
    """Array that compares and hashes by its values."""

    def __init__(self, values: IntArray) -> None:
        self.values = values
        self._key = values.shape, values.tobytes()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Numbers) and self._key == other._key

    def __hash__(self) -> int:
        return hash(self._key)


@lru_cache(CACHED_PATTERNS)
def _built(nodes: int, bars: _Numbers, held: _Numbers) -> SparsityPattern:
    ends, kite = bars.values, held.values
    i, j = ends.T
    dof = 3 * nodes + 12
    free_i, free_j = i < nodes, j < nodes
    plain = np.flatnonzero(free_i & free_j)
    hung = np.flatnonzero((i >= nodes + 6) & free_j)
    rigged = np.flatnonzero((i >= nodes) & (i < nodes + 6))
    board, point = np.divmod(i[rigged] - nodes, 3)
    node = 3 * np.arange(nodes)[:, None] + np.arange(3)
    body = 3 * nodes + 6 * np.arange(2)[:, None] + np.arange(6)
    groups = [
        np.concatenate([node[i[plain]], node[j[plain]]], 1),
        node[j[hung]],
        np.concatenate([body[board], node[j[rigged]]], 1),
        body,
        node,
        node[kite].reshape(1, 9),
    ]
    rows = np.concatenate([np.repeat(g, g.shape[1], 1).ravel() for g in groups])
    cols = np.concatenate([np.tile(g, (1, g.shape[1])).ravel() for g in groups])
    slots, slot = np.unique(cols.astype(np.int64) * dof + rows, return_inverse=True)
    counts = np.bincount(slots // dof, minlength=dof)
    return SparsityPattern(
        dof=dof,
        plain=plain,
        hung=hung,
        rigged=rigged,
        rig_board=board,
        rig_point=point,
        slot=slot.ravel().astype(np.uint32),
        indices=(slots % dof).astype(np.int32),
        indptr=np.concatenate([[0], np.cumsum(counts)]).astype(np.int32),
    )
