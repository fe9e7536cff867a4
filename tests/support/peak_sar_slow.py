#!/usr/bin/env python3
# SPDX-License-Identifier: AGPL-3.0-or-later
"""Compares peak_sar.py in the folder EXAMPLES (assets/examples) with a slow program that shares no code with it.

  peak_sar_slow.py EXAMPLES BODIES

The slow program visits every cell, every direction and every cell of every cube with plain loops. It finds a cube's
side by adding whole layers, and then solves for the fraction of the last layer, whose mass is a polynomial of that
fraction. Compares BODIES random bodies, and bodies written out here whose averages are known without either program.
"""
import random
import sys

sys.path.insert(0, sys.argv[1])
import numpy as np

sys.dont_write_bytecode = True
import peak_sar

NEAR = 1e-9


class Body:
    def __init__(self, size, mass, power):
        self.size, self.mass, self.power = size, mass, power  # mass and power: dictionaries by cell; a missing cell is air

    def cells(self):
        return sorted(self.mass)


def spans(first_whole, count, before, behind):
    """Returns the cells along an axis, each with the fraction that is inside: 1 in between, less for the cells at both
    ends."""
    parts = [(first_whole + i, 1.0) for i in range(count)]
    place = first_whole - 1
    while before > NEAR:
        parts.append((place, min(1.0, before)))
        before -= 1.0
        place -= 1
    place = first_whole + count
    while behind > NEAR:
        parts.append((place, min(1.0, behind)))
        behind -= 1.0
        place += 1
    return parts


def spans_of_cube(cell, side, face):
    """Returns for each axis the cells of a cube around a cell, whose side is given in cells. With a face (axis, end),
    the cube has this face where the cell has it."""
    all_spans = []
    for axis in range(3):
        if face is not None and face[0] == axis:
            if side < 1:
                all_spans.append([(cell[axis], side)])
            elif face[1] == 0:
                all_spans.append(spans(cell[axis], 1, 0.0, side - 1))
            else:
                all_spans.append(spans(cell[axis], 1, side - 1, 0.0))
        elif side < 1:
            all_spans.append([(cell[axis], side)])
        else:
            all_spans.append(spans(cell[axis], 1, (side - 1) / 2, (side - 1) / 2))
    return all_spans


def totals(body, all_spans):
    """Returns mass, power and volume of the tissue in a cube."""
    mass = power = volume = 0.0
    for x, part_x in all_spans[0]:
        for y, part_y in all_spans[1]:
            for z, part_z in all_spans[2]:
                if (x, y, z) in body.mass:
                    part = part_x * part_y * part_z
                    mass += part * body.mass[x, y, z]
                    power += part * body.power[x, y, z]
                    volume += part
    return mass, power, volume


def side_holding(body, cell, wanted, face):
    """Returns the side of the cube that contains the wanted mass. Between two sides at which no cell begins or ends,
    the mass is a cubic of the side: four values determine the cubic, and bisection finds its root."""
    steps = [0.0, 1.0]
    longest = 2 * max(body.size) + 1
    while steps[-1] < longest:
        steps.append(steps[-1] + 1.0)
    for low, high in zip(steps, steps[1:]):
        if totals(body, spans_of_cube(cell, high, face))[0] < wanted * (1 - 1e-12):
            continue
        places = [low + (high - low) * k / 3 for k in range(4)]
        values = [totals(body, spans_of_cube(cell, place, face))[0] if place > 0 else 0.0 for place in places]

        def cubic(side):
            total = 0.0
            for i in range(4):
                term = values[i]
                for j in range(4):
                    if j != i:
                        term *= (side - places[j]) / (places[i] - places[j])
                total += term
            return total

        least, most = low, high
        for _ in range(80):
            middle = (least + most) / 2
            if cubic(middle) < wanted * (1 - 1e-12):
                least = middle
            else:
                most = middle
        return most
    return None


def faces_meet_tissue(body, all_spans):
    for axis in range(3):
        places = [place for place, _ in all_spans[axis]]
        for layer in (min(places), max(places)):
            cut = list(all_spans)
            cut[axis] = [(layer, 1.0)]
            if totals(body, cut)[2] == 0:
                return False
    return True


def slow_average(body, wanted):
    sar, found, of_used = {}, {}, {}
    for cell in body.cells():
        side = side_holding(body, cell, wanted, None)
        if side is None:
            continue
        all_spans = spans_of_cube(cell, side, None)
        _, power, volume = totals(body, all_spans)
        if 1 - volume / side**3 > 0.1 + 1e-12 or not faces_meet_tissue(body, all_spans):
            continue
        sar[cell], found[cell] = power / wanted, peak_sar.VALID
        for x, part_x in all_spans[0]:
            for y, part_y in all_spans[1]:
                for z, part_z in all_spans[2]:
                    if min(part_x, part_y, part_z) > 1 - 2 * NEAR:
                        of_used[x, y, z] = max(of_used.get((x, y, z), 0.0), power / wanted)
    for cell in body.cells():
        if cell in sar:
            continue
        if of_used.get(cell, 0.0) > 0:
            sar[cell], found[cell] = of_used[cell], peak_sar.USED
            continue
        cubes = []
        for axis in range(3):
            for end in (0, 1):
                side = side_holding(body, cell, wanted, (axis, end))
                if side is not None:
                    cubes.append((side**3, totals(body, spans_of_cube(cell, side, (axis, end)))[1] / wanted))
        if not cubes:
            sar[cell], found[cell] = None, peak_sar.WITHOUT
            continue
        smallest = min(cubes)[0]
        sar[cell] = max(average for volume, average in cubes if volume <= 1.05 * smallest * (1 + 1e-12))
        found[cell] = peak_sar.UNUSED
    return sar, found


def arrays_of(body):
    mass, power = np.zeros(body.size), np.zeros(body.size)
    for cell in body.mass:
        mass[cell], power[cell] = body.mass[cell], body.power[cell]
    return power, mass


def check(is_so, text):
    if not is_so:
        print("wrong:", text)
        sys.exit(1)


def compare(body, grams, name):
    fast, fast_found = peak_sar.average_sar(*arrays_of(body), grams)
    slow, slow_found = slow_average(body, grams / 1000)
    for cell in body.cells():
        check(fast_found[cell] == slow_found[cell], f"{name} {cell}: {fast_found[cell]} where the slow program has {slow_found[cell]}")
        if slow[cell] is not None:
            check(abs(fast[cell] - slow[cell]) <= 1e-8 * max(1e-9, abs(slow[cell])), f"{name} {cell}: {fast[cell]!r}, {slow[cell]!r}")
        else:
            check(np.isnan(fast[cell]), f"{name} {cell}: an average though no cube holds the mass")
    return fast, fast_found


def filled(size, is_tissue, mass=lambda c: 0.001, power=lambda c: 1.0):
    places = [(x, y, z) for x in range(size[0]) for y in range(size[1]) for z in range(size[2]) if is_tissue((x, y, z))]
    return Body(size, {c: mass(c) for c in places}, {c: power(c) for c in places})


def by_hand():
    # A uniform cube of tissue with one gram and one watt per cell: any 10 g hold 10 W, and the cube about the middle
    # cell is valid.
    sar, found = compare(filled((7, 7, 7), lambda c: True), 10, "all tissue")
    check(np.allclose(sar, 1000) and found[3, 3, 3] == peak_sar.VALID and found[0, 0, 0] == peak_sar.UNUSED, "all tissue")

    # Power rises by 1 W per layer. The cube about a deep cell has the average of the cell's layer. A cube for a cell of
    # the last layer lies below the cell's outer face, so it has the average at half a side below that face.
    half = filled((9, 9, 9), lambda c: c[2] < 5, power=lambda c: float(c[2] + 1))
    sar, found = compare(half, 10, "half-space")
    check(abs(sar[4, 4, 2] - 3000) < 1e-6 and found[4, 4, 2] == peak_sar.VALID, "half-space, deep")
    side = 10 ** (1 / 3)
    below = (5 * 1 + 4 * 1 + (side - 2) * 3) / side
    check(found[4, 4, 4] == peak_sar.UNUSED and abs(sar[4, 4, 4] - 1000 * below) < 1e-6, "half-space, surface")

    # A row that is one cell wide: no cube is valid, and the cube from the end cell along the row needs ten cells.
    sar, found = compare(filled((1, 1, 12), lambda c: True, power=lambda c: 1.0 if c[2] < 10 else 5.0), 10, "row")
    check((found == peak_sar.UNUSED).all() and abs(sar[0, 0, 0] - 1000) < 1e-6, "row")

    # The corner of a body: of the six cubes on its cell's faces, three reach into the body and are equal, the others
    # are larger.
    sar, found = compare(filled((6, 6, 6), lambda c: True, power=lambda c: 10.0 if c == (0, 0, 0) else 1.0), 10, "corner")
    check(found[0, 0, 0] == peak_sar.UNUSED and sar[0, 0, 0] > 1000, "corner")

    # A cube may contain a hole of one cell in 27, but not one of 26 cells.
    def holed(radius):
        return filled((7, 7, 7), lambda c: max(abs(v - 3) for v in c) >= radius or c == (2, 3, 3))

    _, found = compare(holed(2), 26, "a hole of 26 cells")
    check(found[2, 3, 3] != peak_sar.VALID, "a hole of 26 cells")
    one = filled((7, 7, 7), lambda c: c != (3, 3, 3))
    _, found = compare(one, 26, "a hole of one cell")
    check(found[2, 3, 3] == peak_sar.VALID and found[3, 3, 3] == peak_sar.AIR, "a hole of one cell")

    # Light cells: cubes with sides of 3.2 cells about the third layer's cells are valid, and contain the second layer's
    # cells fully.
    sar, found = compare(filled((6, 6, 6), lambda c: True, mass=lambda c: 0.0003, power=lambda c: float(c[0] + 1)), 10, "light cells")
    check(found[1, 2, 2] == peak_sar.USED and abs(sar[1, 2, 2] - 10000) < 1e-6 and found[0, 2, 2] == peak_sar.UNUSED, "light cells")

    # A cell that weighs more than 10 g is averaged over a part of itself. A body that weighs less than 10 g has no
    # average.
    sar, found = compare(filled((3, 3, 3), lambda c: True, mass=lambda c: 0.02, power=lambda c: 1.0 + c[0]), 10, "heavy cells")
    check(found[0, 0, 0] == peak_sar.VALID and abs(sar[2, 0, 0] - 150) < 1e-6, "heavy cells")
    sar, found = compare(filled((2, 2, 2), lambda c: True), 10, "eight grams")
    check((found == peak_sar.WITHOUT).all() and np.isnan(sar).all(), "eight grams")


def random_body(random_of):
    gram = random_of.choice([0.0003, 0.0008, 0.002])
    size = tuple(6 if gram < 0.0005 else random_of.randint(3, 5) for _ in range(3))
    tissue = random_of.uniform(0.4, 1.3)
    places = [(x, y, z) for x in range(size[0]) for y in range(size[1]) for z in range(size[2]) if random_of.random() < tissue]
    return Body(size, {c: random_of.uniform(0.7, 1.3) * gram for c in places}, {c: random_of.uniform(0, 3) for c in places})


by_hand()
kinds = set()
for seed in range(int(sys.argv[2])):
    body = random_body(random.Random(seed))
    if body.mass:
        kinds |= set(compare(body, 10, f"random body {seed}")[1].flatten().tolist())
check(kinds >= {peak_sar.VALID, peak_sar.USED, peak_sar.UNUSED}, f"random bodies met only {sorted(kinds)}")
print("same")
