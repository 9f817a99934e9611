"""Symbolic factorisation of a gear's matrices: order of elimination, fronts and their assembly.

Unknowns come in threes (a node; a board's place; its turn), so the graph that is eliminated has a
vertex for each block of 3 × 3. A front is a dense matrix of some pivot blocks and of the border of
later blocks that they touch; what is left of the border after elimination is added into the front
of its parent (multifrontal method: Duff and Reid 1983). All depends on the pattern alone and is
found once for a gear.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import splu

from trawl_ros.core.arrays import IntArray
from trawl_ros.model.pattern import SparsityPattern

WIDTH = 3
"""Unknowns of a block."""

MERGED_ZEROS = 4
"""Blocks of zeros with which a front may join its parent's: fewer and larger fronts are faster,
though they hold a little more."""


@dataclass(frozen=True, eq=False)
class Elimination:
    """Order of elimination of a pattern's unknowns, and its fronts in this order.

    ``order`` (dof,) are the unknowns as they are eliminated. ``fronts`` (n, 7) has a row for each
    front: number of its pivots, its size, number of its children, where its entries end in
    ``slots`` and ``places``, where its border begins in ``border`` (unknowns in this order) and in
    ``parents_rows`` (their rows in the parent's front), and where its factors begin. The entry of
    the matrix at ``slots[k]`` goes to ``places[k]`` of its flattened front. ``fill`` numbers are in
    the factors, ``largest`` ** 2 in the largest front, ``waiting`` in borders that wait for their
    parent at most.
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
    starts = pattern.indptr[::WIDTH]
    touched = [
        pattern.indices[start : start + count : WIDTH] // WIDTH
        for start, count in zip(starts, np.diff(pattern.indptr)[::WIDTH], strict=False)
    ]
    sequence = _minimum_degree(touched)
    return _numbered(pattern, sequence, _postordered(_trees(touched, sequence)))


def _minimum_degree(touched: list[IntArray]) -> IntArray:
    """Blocks in an order of minimum degree, which fills in little."""
    count = len(touched)
    indices = np.concatenate(touched)
    indptr = np.concatenate([[0], np.cumsum([len(blocks) for blocks in touched])])
    diagonal = indices == np.repeat(np.arange(count), np.diff(indptr))
    # Any values will do that keep the pivots on the diagonal.
    graph = sp.csc_matrix((np.where(diagonal, 1.0, 1e-3 / count), indices, indptr))
    found = splu(graph, permc_spec='MMD_AT_PLUS_A', options={'SymmetricMode': True})
    order: IntArray = np.argsort(found.perm_c)
    return order


def _trees(touched: list[IntArray], sequence: IntArray) -> list[_Front]:
    """Roots of the trees of fronts; each front has joined such children as add few zeros."""
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
    while front.children:
        size = len(front.pivots) + len(front.border)
        zeros = [len(child.pivots) * (size - len(child.border)) for child in front.children]
        least = int(np.argmin(zeros))
        if zeros[least] > MERGED_ZEROS:
            return
        child = front.children.pop(least)
        front.pivots[:0] = child.pivots
        front.children.extend(child.children)


def _postordered(roots: list[_Front]) -> list[_Front]:
    """All fronts, each after its children and right after the last of them."""
    ordered: list[_Front] = []
    todo = list(roots)
    while todo:
        front = todo.pop()
        ordered.append(front)
        todo.extend(front.children)
    return ordered[::-1]


def _numbered(pattern: SparsityPattern, sequence: IntArray, fronts: list[_Front]) -> Elimination:
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
    pivots, sizes = WIDTH * pivots, WIDTH * sizes
    edges = sizes - pivots
    factors = pivots * (sizes + edges)
    table = np.column_stack(
        [
            pivots,
            sizes,
            [len(front.children) for front in fronts],
            np.cumsum(entries),
            np.cumsum(edges) - edges,
            np.cumsum(edges // WIDTH) - edges // WIDTH,
            np.cumsum(factors) - factors,
        ]
    )
    return Elimination(
        order=_unknowns(blocks),
        fronts=np.ascontiguousarray(table),
        slots=slots.astype(np.uint32),
        places=places.astype(np.uint32),
        border=_unknowns(np.concatenate(borders)).astype(np.uint32),
        parents_rows=WIDTH * np.concatenate(rows or [np.empty(0, int)]).astype(np.uint32),
        fill=int(factors.sum()),
        largest=int(sizes.max()),
        waiting=_most_waiting(table, edges),
    )


def _unknowns(blocks: IntArray) -> IntArray:
    unknowns: IntArray = (WIDTH * blocks[:, None] + np.arange(WIDTH)).ravel()
    return unknowns


def _rows(blocks: IntArray, first: int, pivots: int, border: IntArray) -> IntArray:
    """Rows of blocks in a front, in blocks."""
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
    """Slots of the matrix, their places in the fronts, and how many there are in each front.

    An entry belongs to the front in which the first of its row and column is a pivot.
    """
    place = np.argsort(blocks)
    columns = np.repeat(np.arange(pattern.dof), np.diff(pattern.indptr))
    row, column = place[pattern.indices // WIDTH], place[columns // WIDTH]
    front = owner[np.minimum(row, column)]
    slots = np.argsort(front, kind='stable')
    entries = np.bincount(front, minlength=len(borders))
    places = np.empty(len(slots), int)
    for number, chosen in enumerate(np.split(slots, np.cumsum(entries)[:-1])):
        at = firsts[number], pivots[number], borders[number]
        down = WIDTH * _rows(row[chosen], *at) + pattern.indices[chosen] % WIDTH
        across = WIDTH * _rows(column[chosen], *at) + columns[chosen] % WIDTH
        places[chosen] = down * WIDTH * (pivots[number] + len(borders[number])) + across
    return slots, places[slots], entries


def _most_waiting(table: IntArray, edges: IntArray) -> int:
    stack: list[int] = []
    held = most = 0
    for children, edge in zip(table[:, 2], edges, strict=True):
        for _ in range(children):
            held -= stack.pop()
        stack.append(int(edge) ** 2)
        held += stack[-1]
        most = max(most, held)
    return most
