# SPDX-License-Identifier: AGPL-3.0-or-later
"""Specific absorption rate averaged over cubes of a given mass [IEC/IEEE 62704-1:2017, 6.2].

A cube about the centre of each tissue cell grows to all sides until it holds the mass; its sides lie where they lie,
also between the faces of cells, whose part inside counts. It is valid when at most a tenth of it is air and each of its
six faces meets tissue. The average of a valid cube is that of its centre's cell. Another cell that lies wholly in valid
cubes has the largest average of those. What is left, near the surface, stands in the middle of a face of six cubes, one
for each side, which grow until they hold the mass, with whatever air there is: of the smallest of them, and of those
that are at most 5 % larger, the largest average holds.

Needs numpy. All arrays have one value a cell, cells are cubes, and what lies around the arrays is air.
"""
import numpy as np

MOST_AIR = 0.1  # of a valid cube's volume
MUCH_LARGER = 1.05  # than the smallest of six cubes: left out
NEAR = 1e-9  # cells: sides closer to a face of cells than this lie on it
AIR, VALID, USED, UNUSED, WITHOUT = range(5)  # how a cell's average was found; WITHOUT: no cube holds the mass


class BoxSums:
    """Sums over boxes whose sides may lie anywhere: cells count by the part that is inside."""

    def __init__(self, values):
        self.sums = np.pad(values.astype(float), ((1, 0),) * 3).cumsum(0).cumsum(1).cumsum(2)

    def up_to(self, corner):
        """The sum below a point, in cells: it is linear along each axis within a cell."""
        size = np.array(self.sums.shape) - 1
        corner = np.clip(corner, 0, size[:, None])
        low = np.minimum(np.floor(corner).astype(int), size[:, None] - 1)
        part = corner - low
        total = 0.0
        for k in range(8):
            step = np.array([k >> axis & 1 for axis in range(3)])
            weight = np.prod(np.where(step[:, None] == 1, part, 1 - part), axis=0)
            total = total + weight * self.sums[tuple(low + step[:, None])]
        return total

    def within(self, low, high):
        total = 0.0
        for k in range(8):
            is_high = np.array([k >> axis & 1 for axis in range(3)])
            total = total + (-1) ** (3 - is_high.sum()) * self.up_to(np.where(is_high[:, None] == 1, high, low))
        return total


def box_about(cells, side, face):
    """Corners, in cells, of cubes about cells; with a face (axis, 0 low or 1 high) the cell's lies in the cube's."""
    low, high = cells + 0.5 - side / 2, cells + 0.5 + side / 2
    if face is not None:
        axis, end = face
        low[axis] = cells[axis] if end == 0 else cells[axis] + 1 - side
        high[axis] = low[axis] + side
    return low, high


def sides_holding(mass_sums, cells, mass, face, longest):
    """Side, in cells, of the cube about each cell that holds `mass`; nan where even the longest does not."""
    least, most = np.zeros(cells.shape[1]), np.full(cells.shape[1], float(longest))
    reached = mass_sums.within(*box_about(cells, most, face)) >= mass * (1 - 1e-12)
    for _ in range(70):
        middle = (least + most) / 2
        enough = mass_sums.within(*box_about(cells, middle, face)) >= mass * (1 - 1e-12)
        least, most = np.where(enough, least, middle), np.where(enough, middle, most)
    return np.where(reached, most, np.nan)


def cells_touched(low, high):
    """First cell of a box and the end behind its last, along each axis; a cell that it only touches is not in it."""
    return np.floor(low + NEAR).astype(int), np.ceil(high - NEAR).astype(int)


def cells_inside(low, high):
    return np.ceil(low - NEAR).astype(int), np.floor(high + NEAR).astype(int)


def faces_meet_tissue(tissue_sums, low, high):
    first, end = cells_touched(low, high)
    met = np.ones(low.shape[1], bool)
    for axis in range(3):
        for layer in (first[axis], end[axis] - 1):
            slab_low, slab_high = first.astype(float), end.astype(float)
            slab_low[axis], slab_high[axis] = layer, layer + 1
            met &= tissue_sums.within(slab_low, slab_high) > 0.5
    return met


def average_sar(power, mass, grams):
    """W/kg of each cell over cubes of so many grams, 0 in air, nan where no cube holds so much; and how each was found.

      power, mass  W and kg of each cell; mass 0: air
    """
    wanted = grams / 1000
    tissue = mass > 0
    cells = np.array(np.nonzero(tissue))
    longest = 2 * max(mass.shape) + 1
    power_sums, mass_sums, tissue_sums = BoxSums(np.where(tissue, power, 0)), BoxSums(mass), BoxSums(tissue)
    sar, found = np.zeros(mass.shape), np.full(mass.shape, AIR)

    side = sides_holding(mass_sums, cells, wanted, None, longest)
    low, high = box_about(cells, np.nan_to_num(side, nan=1.0), None)
    air = 1 - tissue_sums.within(low, high) / np.nan_to_num(side, nan=1.0) ** 3
    valid = ~np.isnan(side) & (air <= MOST_AIR + 1e-12)
    valid &= faces_meet_tissue(tissue_sums, low, high)
    average = power_sums.within(low, high) / wanted
    sar[tuple(cells[:, valid])] = average[valid]
    found[tuple(cells[:, valid])] = VALID

    of_used = np.zeros(mass.shape)
    first, end = cells_inside(low[:, valid], high[:, valid])
    for value, (x, y, z), (to_x, to_y, to_z) in zip(average[valid], first.T, end.T):
        box = of_used[x:to_x, y:to_y, z:to_z]
        np.maximum(box, value, out=box)
    used = tissue & (found != VALID) & (of_used > 0)
    sar[used], found[used] = of_used[used], USED

    left = np.array(np.nonzero(tissue & (found == AIR)))
    if left.size:
        sar[tuple(left)], found[tuple(left)] = over_six_cubes(power_sums, mass_sums, left, wanted, longest)
    return sar, found


def over_six_cubes(power_sums, mass_sums, cells, wanted, longest):
    sides, averages = [], []
    for face in [(axis, end) for axis in range(3) for end in (0, 1)]:
        side = sides_holding(mass_sums, cells, wanted, face, longest)
        low, high = box_about(cells, np.nan_to_num(side, nan=1.0), face)
        sides.append(np.where(np.isnan(side), np.inf, side))
        averages.append(power_sums.within(low, high) / wanted)
    volumes = np.array(sides) ** 3
    smallest = volumes.min(0)
    is_near = np.isfinite(volumes) & (volumes <= MUCH_LARGER * smallest * (1 + 1e-12))
    best = np.where(is_near, averages, -np.inf).max(0)
    has_one = np.isfinite(smallest)
    return np.where(has_one, best, np.nan), np.where(has_one, UNUSED, WITHOUT)
