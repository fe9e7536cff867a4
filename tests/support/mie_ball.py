#!/usr/bin/env python3
# SPDX-License-Identifier: AGPL-3.0-or-later
"""Compares peak_sar.py in the folder EXAMPLES (assets/examples) with Mie's exact field in a ball of tissue.

  mie_ball.py EXAMPLES

A plane wave of 1 W/m2, polarized along x and going towards z, meets a homogeneous ball. The field inside it is Mie's
series [Bohren & Huffman 1983, chapter 4, with the time factor exp(-i w t)]. The series is checked first: the tangential
field is continuous at the ball's surface, and the absorbed power is extinction minus scattering. Then the field is
sampled at the centres of cells, and the averages of peak_sar.py are compared with integrals of the exact field over
exact cubes of 10 g.
"""
import sys

import numpy as np

sys.dont_write_bytecode = True
sys.path.insert(0, sys.argv[1])
import peak_sar

LIGHT, EPS_0, IMPEDANCE = 299792458.0, 8.8541878128e-12, 376.730313668
FREQUENCY = 900e6  # Hz
RADIUS = 0.06  # m
# Values of muscle: relative permittivity, conductivity in S/m, density in kg/m3.
EPSILON, KAPPA, DENSITY = 55.0, 0.94, 1040.0
GRAMS = 10
K = 2 * np.pi * FREQUENCY / LIGHT
M = np.sqrt(EPSILON + 1j * KAPPA / (2 * np.pi * FREQUENCY * EPS_0))  # refractive index
ORDERS = np.arange(1, 26)


def check(is_so, text):
    if not is_so:
        print("wrong:", text)
        sys.exit(1)


def spherical_j(z):
    """Returns j_1 .. j_N and [z j_n]' / z for each order n, by downward recurrence of the ratios j_n / j_(n-1)."""
    z = np.asarray(z, complex)
    ratio = np.zeros((len(ORDERS) + 1, *z.shape), complex)
    after = np.zeros_like(z)
    for n in range(len(ORDERS) + 40, 0, -1):
        after = 1 / ((2 * n + 1) / z - after)
        if n <= len(ORDERS):
            ratio[n] = after
    j = [np.sin(z) / z]
    for n in ORDERS:
        j.append(j[-1] * ratio[n])
    return np.array(j[1:]), np.array([j[n - 1] - n * j[n] / z for n in ORDERS])


def spherical_h(x):
    """Returns h_1 .. h_N of the first kind and [x h_n]' / x for each order n and real x; y_n by upward recurrence."""
    y = [-np.cos(x) / x, -np.cos(x) / x**2 - np.sin(x) / x]
    for n in ORDERS[1:]:
        y.append((2 * n - 1) / x * y[n - 1] - y[n - 2])
    j, _ = spherical_j(x)
    h = np.array([np.sin(x) / x + 1j * y[0]] + [j[n - 1] + 1j * y[n] for n in ORDERS])
    return h[1:], np.array([h[n - 1] - n * h[n] / x for n in ORDERS])


def coefficients():
    """Returns the coefficients a, b of the scattered field and c, d of the field inside the ball."""
    x = K * RADIUS
    jx, djx = spherical_j(x)
    jm, djm = spherical_j(M * x)
    hx, dhx = spherical_h(x)
    top = jx * dhx - hx * djx
    electric, magnetic = M * jm * dhx - hx * djm, jm * dhx - M * hx * djm
    return (M * jm * djx - jx * djm) / electric, (jm * djx - M * jx * djm) / magnetic, top / magnetic, top / electric


A, B, C, D = coefficients()


def field(magnetic, electric, z, dz, argument, theta, phi):
    """Returns E along r, theta, phi for |E_0| = 1: the sum of i^n (2n + 1) / (n (n + 1)) (magnetic M_o1n -
    i electric N_e1n).

    z, dz  for each order n: the radial function z_n(argument), and [argument z_n]' / argument
    """
    mu = np.cos(theta)
    before, pi = np.zeros_like(mu), np.ones_like(mu)
    total = np.zeros((3, *mu.shape), complex)
    for k, n in enumerate(ORDERS):
        tau = n * mu * pi - (n + 1) * before
        scale = 1j**n * (2 * n + 1) / (n * (n + 1))
        total[0] -= scale * 1j * electric[k] * np.cos(phi) * n * (n + 1) * np.sin(theta) * pi * z[k] / argument
        total[1] += scale * np.cos(phi) * (magnetic[k] * pi * z[k] - 1j * electric[k] * tau * dz[k])
        total[2] -= scale * np.sin(phi) * (magnetic[k] * tau * z[k] - 1j * electric[k] * pi * dz[k])
        before, pi = pi, ((2 * n + 1) * mu * pi - (n + 1) * before) / n
    return total


def sar_at(x, y, z):
    """Returns the SAR in W/kg at points (m) inside the ball, whose centre is the origin."""
    r = np.maximum(np.sqrt(x * x + y * y + z * z), 1e-9)
    argument = M * K * r
    j, dj = spherical_j(argument)
    theta, phi = np.arccos(np.clip(z / r, -1, 1)), np.arctan2(y, x)
    squared = (abs(field(C, D, j, dj, argument, theta, phi)) ** 2).sum(0)
    return KAPPA / (2 * DENSITY) * squared * 2 * IMPEDANCE


def gauss(low, high, count):
    places, weights = np.polynomial.legendre.leggauss(count)
    return (high - low) / 2 * places + (high + low) / 2, (high - low) / 2 * weights


def absorbed_by_series():
    """Returns the absorbed power in W: the field inside, integrated over the ball."""
    r, wr = gauss(0, RADIUS, 40)
    mu, wm = gauss(-1, 1, 40)
    phi = np.arange(4) * np.pi / 4 + 0.1  # four angles integrate cos and sin squared exactly
    r, mu, phi = np.meshgrid(r, mu, phi, indexing="ij")
    side = r * np.sqrt(1 - mu**2)
    sar = sar_at(side * np.cos(phi), side * np.sin(phi), r * mu)
    return DENSITY * np.einsum("ijk,i,j->", sar * r**2, wr, wm) * np.pi / 2


def absorbed_by_extinction():
    x = K * RADIUS
    weight = 2 * ORDERS + 1
    return 2 / x**2 * (weight * ((A + B).real - abs(A) ** 2 - abs(B) ** 2)).sum() * np.pi * RADIUS**2


def check_series():
    theta, phi = np.linspace(0.1, 3.0, 7), np.linspace(0.3, 6.0, 7)
    x = np.full_like(theta, K * RADIUS)
    j, dj = spherical_j(x)
    h, dh = np.array([np.outer(part, np.ones_like(x)) for part in spherical_h(K * RADIUS)])
    one = np.ones_like(A)
    outside = field(one, one, j, dj, x, theta, phi) + field(-B, -A, h, dh, x, theta, phi)
    inside = field(C, D, *spherical_j(M * x), M * x, theta, phi)
    check(abs(inside[1:] - outside[1:]).max() < 1e-9, "the tangential field jumps at the surface")
    check(abs(inside[0] * M**2 - outside[0]).max() < 1e-9, "the normal displacement jumps at the surface")
    lost, taken = absorbed_by_extinction(), absorbed_by_series()
    check(abs(taken / lost - 1) < 1e-9, f"the field inside absorbs {taken} W, the wave loses {lost} W")


def cube_average(centre, side):
    """Returns the mean SAR in W/kg over a cube that lies inside the ball."""
    axes = [gauss(c - side / 2, c + side / 2, 10) for c in centre]
    (x, wx), (y, wy), (z, wz) = axes
    return np.einsum("ijk,i,j,k->", sar_at(*np.meshgrid(x, y, z, indexing="ij")), wx, wy, wz) / side**3


def cube_behind(x, y, face, side):
    """Returns the mass (kg) and the power (W) of the tissue in a cube around the line through x, y whose face is at
    z = face."""
    (x, wx), (y, wy) = gauss(x - side / 2, x + side / 2, 16), gauss(y - side / 2, y + side / 2, 16)
    u, wu = gauss(0, 1, 16)
    front = np.maximum(face, -np.sqrt(RADIUS**2 - x[:, None] ** 2 - y[None] ** 2))
    depth = face + side - front
    z = front[..., None] + depth[..., None] * u
    sar = sar_at(*np.broadcast_arrays(x[:, None, None], y[None, :, None], z))
    mass = DENSITY * np.einsum("ij,i,j->", depth, wx, wy)
    return mass, DENSITY * np.einsum("ijk,ij,i,j,k->", sar, depth, wx, wy, wu)


def average_behind(x, y, face):
    """Returns the mean SAR in W/kg over the cube with its face at z = face whose side is such that it contains 10 g."""
    low, high = 0.01, 0.05
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if cube_behind(x, y, face, middle)[0] < GRAMS / 1000 else (low, middle)
    return cube_behind(x, y, face, high)[1] / (GRAMS / 1000)


def cells_of_ball(cell):
    count = int(np.ceil(RADIUS / cell)) + 1
    centres = cell * (np.arange(-count, count) + 0.5)
    x, y, z = np.meshgrid(centres, centres, centres, indexing="ij")
    inside = x * x + y * y + z * z <= RADIUS**2
    sar = np.zeros(inside.shape)
    sar[inside] = sar_at(x[inside], y[inside], z[inside])
    mass = np.where(inside, DENSITY * cell**3, 0)
    return (x, y, z), sar * mass, mass


def compare(cell, most_of_average, most_in_depth, most_at_front, most_of_peak):
    """Compares the averages in cells of size `cell` (m) with the exact ones. The limits are relative; smaller cells
    have smaller ones."""
    (x, y, z), power, mass = cells_of_ball(cell)
    averages, found = peak_sar.average_sar(power, mass, GRAMS)
    name = f"cells of {1000 * cell:g} mm"
    whole = power.sum() / mass.sum() / (absorbed_by_extinction() / (DENSITY * 4 / 3 * np.pi * RADIUS**3)) - 1
    check(abs(whole) < most_of_average, f"{name}: the average over the ball is off by {whole}")

    side = (GRAMS / 1000 / DENSITY) ** (1 / 3)
    away = [abs(axis) + side / 2 for axis in (x, y, z)]
    deep = np.argwhere((mass > 0) & (away[0] ** 2 + away[1] ** 2 + away[2] ** 2 < (RADIUS - cell) ** 2))
    deep = [tuple(index) for index in deep[:: len(deep) // 80]]
    check(all(found[index] == peak_sar.VALID for index in deep), f"{name}: a cube within the ball does not count")
    errors = np.array([averages[i] / cube_average((x[i], y[i], z[i]), side) - 1 for i in deep])
    off = np.sqrt((errors**2).mean())
    check(off < most_in_depth, f"{name}: averages in depth are off by {off}")

    middle = mass.shape[0] // 2
    front = (middle, middle, middle - round(RADIUS / cell))
    check(found[front] == peak_sar.UNUSED, f"{name}: the cell that the wave meets first lies in a cube that counts")
    off = averages[front] / average_behind(x[front], y[front], -RADIUS) - 1
    check(abs(off) < most_at_front, f"{name}: the average at the front is off by {off}")

    peak = np.nanmax(averages) / cube_average((0, 0, 0), side) - 1  # the ball focuses the wave on its centre
    check(abs(peak) < most_of_peak, f"{name}: the peak is off by {peak}")
    print(f"{name}: whole {whole:+.5f}, front {off:+.4f}, peak {peak:+.4f}", file=sys.stderr)


check_series()
compare(0.006, 0.001, 0.02, 0.012, 0.1)
compare(0.004, 0.001, 0.004, 0.009, 0.04)
print("same")
