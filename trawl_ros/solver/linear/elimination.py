# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Symbolic factorisation of a gear's matrices: order of elimination, fronts and their assembly.

Unknowns come in threes (a node; a board's place; its turn), so the graph that is eliminated has a
vertex for each block of 3 × 3. A front is a dense matrix of some pivot blocks and of the border of
later blocks that they touch. After elimination the Schur complement of the border is added to the
front of its parent (multifrontal method: Duff and Reid 1983). All of it depends only on the
pattern and is computed once for a gear.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import splu

from trawl_ros.core.arrays import IntArray
from trawl_ros.model.pattern import SparsityPattern

UNKNOWNS_PER_BLOCK = 3
"""Unknowns of a block."""

MAX_MERGED_ZERO_BLOCKS = 4
"""Zero blocks that merging a front into its parent may add: fewer, larger fronts are faster."""


@dataclass(frozen=True, eq=False)
class Elimination:
    """Order of elimination of a pattern's unknowns, and its fronts in this order.

    Attributes
    ----------
    order : (dof,) array
        Unknowns in the order of elimination.
    fronts : (n, 7) array
        For each front: number of pivots, size, number of children, end of its entries in ``slots``
        and ``places``, start in ``border``, start in ``parents_rows``, start of its factors.
    slots, places : arrays
        The matrix entry at ``slots[k]`` goes to ``places[k]`` of its flattened front.
    border
        Unknowns of the borders, in the order of elimination.
    parents_rows
        Their rows in the parent's front, one for each block.
    fill
        Number of values in the factors.
    largest
        Size of the largest front.
    waiting
        Largest number of values in update matrices that wait for their parents.
    """

    order: IntArray
    fronts: IntArray
    slots: NDArray[np.uint32]
    places: NDArray[np.uint32]
    border: NDArray[np.uint32]
    parents_rows: NDArray[np.uint32]
    fill: int
    largest: int
    waiting: int


@dataclass
class _Front:
    """Front under construction, in blocks numbered in the order of minimum degree."""

    pivots: list[int]
    border: set[int]
    children: list['_Front']


@lru_cache(maxsize=16)
def elimination(pattern: SparsityPattern) -> Elimination:
    """Find the order of elimination and the fronts of a pattern."""
    starts = pattern.indptr[::UNKNOWNS_PER_BLOCK]
    touched = [
        pattern.indices[start : start + count : UNKNOWNS_PER_BLOCK] // UNKNOWNS_PER_BLOCK
        for start, count in zip(starts, np.diff(pattern.indptr)[::UNKNOWNS_PER_BLOCK], strict=False)
    ]
    sequence = _minimum_degree(touched)
    return _numbered(pattern, sequence, _postordered(_trees(touched, sequence)))


def _minimum_degree(touched: list[IntArray]) -> IntArray:
    """Order the blocks by minimum degree, which keeps the fill low."""
    count = len(touched)
    indices = np.concatenate(touched)
    indptr = np.concatenate([[0], np.cumsum([len(blocks) for blocks in touched])])
    diagonal = indices == np.repeat(np.arange(count), np.diff(indptr))
    # SuperLU only orders here; these values keep its pivots on the diagonal.
    graph = sp.csc_matrix((np.where(diagonal, 1.0, 1e-3 / count), indices, indptr))
    found = splu(graph, permc_spec='MMD_AT_PLUS_A', options={'SymmetricMode': True})
    order: IntArray = np.argsort(found.perm_c)
    return order


def _trees(touched: list[IntArray], sequence: IntArray) -> list[_Front]:
    """Build the elimination trees and return their roots; merge children that add few zeros."""
    place = np.argsort(sequence)
    waiting: dict[int, list[_Front]] = {}
    roots = []
    for number, block in enumerate(sequence):
        children = waiting.pop(number, [])
        border = {int(other) for other in place[touched[block]] if other > number}
        border.update(*(child.border for child in children))
        border.discard(number)
        front = _Front([number], border, children)
        _join_children(front)
        if border:
            waiting.setdefault(min(border), []).append(front)
        else:
            roots.append(front)
    return roots


def _join_children(front: _Front) -> None:
    """Merge children into a front, the cheapest first, as long as they add few zeros."""
    while front.children:
        size = len(front.pivots) + len(front.border)
        zeros = [len(child.pivots) * (size - len(child.border)) for child in front.children]
        least = int(np.argmin(zeros))
        if zeros[least] > MAX_MERGED_ZERO_BLOCKS:
            return
        child = front.children.pop(least)
        front.pivots[:0] = child.pivots
        front.children.extend(child.children)


def _postordered(roots: list[_Front]) -> list[_Front]:
    """Return all fronts in postorder: each right after the last of its children."""
    ordered: list[_Front] = []
    todo = list(roots)
    while todo:
        front = todo.pop()
        ordered.append(front)
        todo.extend(front.children)
    return ordered[::-1]


def _numbered(pattern: SparsityPattern, sequence: IntArray, fronts: list[_Front]) -> Elimination:
    """Number blocks in the order of elimination, and describe the fronts by these numbers."""
    pivots = np.array([len(front.pivots) for front in fronts])
    firsts = np.cumsum(pivots) - pivots
    by_sequence = np.concatenate([front.pivots for front in fronts])
    place = np.argsort(by_sequence)
    borders = [np.sort(place[np.fromiter(front.border, int)]) for front in fronts]
    owner = np.repeat(np.arange(len(fronts)), pivots)
    sizes = pivots + np.array([len(border) for border in borders])
    rows = []
    for border in borders:
        if len(border):
            parent = owner[border[0]]
            rows.append(_rows(border, firsts[parent], pivots[parent], borders[parent]))
    blocks = sequence[by_sequence]
    slots, places, entries = _assembly(pattern, blocks, owner, firsts, pivots, borders)
    pivots, sizes = UNKNOWNS_PER_BLOCK * pivots, UNKNOWNS_PER_BLOCK * sizes
    edges = sizes - pivots
    factors = pivots * (sizes + edges)
    table = np.column_stack(
        [
            pivots,
            sizes,
            [len(front.children) for front in fronts],
            np.cumsum(entries),
            np.cumsum(edges) - edges,
            np.cumsum(edges // UNKNOWNS_PER_BLOCK) - edges // UNKNOWNS_PER_BLOCK,
            np.cumsum(factors) - factors,
        ]
    )
    return Elimination(
        order=_unknowns(blocks),
        fronts=np.ascontiguousarray(table),
        slots=slots.astype(np.uint32),
        places=places.astype(np.uint32),
        border=_unknowns(np.concatenate(borders)).astype(np.uint32),
        parents_rows=UNKNOWNS_PER_BLOCK
        * np.concatenate(rows or [np.empty(0, int)]).astype(np.uint32),
        fill=int(factors.sum()),
        largest=int(sizes.max()),
        waiting=_most_waiting(table, edges),
    )


def _unknowns(blocks: IntArray) -> IntArray:
    """Return the numbers of the unknowns of blocks, one after the other."""
    unknowns: IntArray = (
        UNKNOWNS_PER_BLOCK * blocks[:, None] + np.arange(UNKNOWNS_PER_BLOCK)
    ).ravel()
    return unknowns


def _rows(blocks: IntArray, first: int, pivots: int, border: IntArray) -> IntArray:
    """Return the rows of blocks in a front, counted in blocks."""
    behind = pivots + np.searchsorted(border, blocks)
    return np.where(blocks < first + pivots, blocks - first, behind)


def _assembly(
    pattern: SparsityPattern,
    blocks: IntArray,
    owner: IntArray,
    firsts: IntArray,
    pivots: IntArray,
    borders: list[IntArray],
) -> tuple[IntArray, IntArray, IntArray]:
    """Return slots of the matrix, their places in the fronts, and their number in each front.

    An entry belongs to the front in which the first of its row and column is a pivot.
    """
    place = np.argsort(blocks)
    columns = np.repeat(np.arange(pattern.dof), np.diff(pattern.indptr))
    row, column = place[pattern.indices // UNKNOWNS_PER_BLOCK], place[columns // UNKNOWNS_PER_BLOCK]
    front = owner[np.minimum(row, column)]
    slots = np.argsort(front, kind='stable')
    entries = np.bincount(front, minlength=len(borders))
    places = np.empty(len(slots), int)
    for number, chosen in enumerate(np.split(slots, np.cumsum(entries)[:-1])):
        at = firsts[number], pivots[number], borders[number]
        down = (
            UNKNOWNS_PER_BLOCK * _rows(row[chosen], *at)
            + pattern.indices[chosen] % UNKNOWNS_PER_BLOCK
        )
        across = (
            UNKNOWNS_PER_BLOCK * _rows(column[chosen], *at) + columns[chosen] % UNKNOWNS_PER_BLOCK
        )
        places[chosen] = (
            down * UNKNOWNS_PER_BLOCK * (pivots[number] + len(borders[number])) + across
        )
    return slots, places[slots], entries


def _most_waiting(table: IntArray, edges: IntArray) -> int:
    """Return the largest number of values that wait on the stack, child by child taken off it."""
    stack: list[int] = []
    held = most = 0
    for children, edge in zip(table[:, 2], edges, strict=True):
        for _ in range(children):
            held -= stack.pop()
        stack.append(int(edge) ** 2)
        held += stack[-1]
        most = max(most, held)
    return most
