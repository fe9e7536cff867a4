#!/usr/bin/env python3
# SPDX-License-Identifier: AGPL-3.0-or-later
"""Specific absorption rate (SAR) of a posed limb in a plane wave, computed by openEMS [Liebig et al. 2013, IJNM 26, 680].

  sar_openems.py deck DECK.xml [...] [--cell MM] [--polarization x|y|z] [--towards x|y|z] -o SAR.json [--plot SAR.svg]
  sar_openems.py sphere -o SPHERE.json
  sar_openems.py study OUT [--method fem-contact] [--spacing MM] [--poses A,B] [--frequency HZ] [--cell MM] [--limber PROGRAM]

DECK.xml is what `limber convert POSED.nrrd DECK.xml --frequency HZ` writes: boxes of tissues with permittivity, conductivity and
density. For each deck: the SAR averaged over all tissue and its largest average over 10 g (by peak_sar.py, which lies
beside this program), in W/kg for an incident power density of 1 W/m2 at the deck's frequency. `sphere` does the same for a ball of muscle-like tissue and compares the power it takes up with
Mie's exact solution [Bohren & Huffman 1983, 4.4]; it exits with 1 where they differ by more than 10 %. `study` does both for the
posed bodies of a study that `limber experiment ... -o OUT` has computed, and writes OUT/sar.json (schema limber-sar/2, see
core/study/sar_figures.h): the next `limber experiment ... -o OUT` shows it as a figure of its page.

Needs openEMS (Debian: openems), h5py, numpy and scipy. Every run works in a folder of its own that is taken away again.
"""
import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree as ET
from xml.sax.saxutils import escape

import h5py
import numpy as np
from scipy.special import spherical_jn, spherical_yn

sys.dont_write_bytecode = True
import peak_sar

LIGHT = 299792458.0  # m/s
EPS_0 = 8.8541878128e-12  # F/m
PADDING = 10  # cells of air between tissue and the box in which the wave is made
AROUND = 4  # cells between that box and the absorbing layer
PML = 8  # cells
MARGIN = PADDING + AROUND + PML
GRAMS = 10  # that SAR is averaged over
FOUND = ("air", "cube about the cell", "cube that holds the cell", "cube with the cell in its face", "none")  # as peak_sar counts
SOUNDEST = ("fem-contact", "fem", "dqs", "lbs")  # methods of a study: the mass of a limb that passes through itself is not that of the limb


class Deck:
    """Tissues on a grid of cubes: index of a material per cell (-1 air), and the materials."""

    def __init__(self, index, cell, materials, frequency):
        self.index, self.cell, self.materials, self.frequency = index, cell, materials, frequency

    def of_cells(self, key):
        values = np.array([m[key] for m in self.materials] + [{"epsilon": 1.0}.get(key, 0.0)])
        return values[self.index]


def read_deck(path, cell):
    """The boxes sampled at the centres of cubes of `cell` mm; none: as fine as the deck."""
    root = ET.parse(path).getroot()
    frequency = float(root.find("FDTD/Excitation").get("f0"))
    grid = root.find("ContinuousStructure/RectilinearGrid")
    lines = [np.array([float(v) for v in grid.find(axis + "Lines").text.split(",")]) for axis in "XYZ"]
    cell = cell or float(min(np.diff(line).min() for line in lines))
    low = np.array([line[0] for line in lines])
    size = [int(np.ceil((line[-1] - line[0]) / cell - 1e-6)) for line in lines]
    centres = [low[a] + cell * (np.arange(size[a]) + 0.5) for a in range(3)]
    index = np.full(size, -1, np.int32)
    materials = []
    for material in root.iter("Material"):
        properties = material.find("Property")
        for box in material.iter("Box"):
            ends = [sorted(float(box.find(p).get(axis)) for p in ("P1", "P2")) for axis in "XYZ"]
            inside = tuple(slice(*np.searchsorted(centres[a], ends[a])) for a in range(3))
            index[inside] = len(materials)
        materials.append({"name": material.get("Name"), "epsilon": float(properties.get("Epsilon")), "kappa": float(properties.get("Kappa")), "density": float(properties.get("Density"))})
    return Deck(index, cell, materials, frequency)


def ball(radius, cell, material, frequency):
    size = 2 * int(np.ceil(radius / cell)) + 2
    away = cell * (np.indices((size,) * 3) + 0.5 - size / 2)
    return Deck(np.where((away**2).sum(0) <= radius**2, 0, -1), cell, [material], frequency)


def runs_of(index):
    """Runs of one material along z: (x, y, first z, end, material)."""
    change = np.diff(index, axis=2, prepend=-2) != 0
    x, y, first = np.nonzero(change)
    same_row = np.append((x[1:] == x[:-1]) & (y[1:] == y[:-1]), False)
    end = np.where(same_row, np.append(first[1:], 0), index.shape[2])
    material = index[x, y, first]
    return [run for run in zip(x, y, first, end, material) if run[4] >= 0]


def write_simulation(deck, path, polarization, towards):
    cell = deck.cell
    total = [n + 2 * MARGIN for n in deck.index.shape]
    root = ET.Element("openEMS")
    fdtd = ET.SubElement(root, "FDTD", NumberOfTimesteps="30000", endCriteria="1e-5", f_max=str(1.5 * deck.frequency))
    ET.SubElement(fdtd, "Excitation", Type="0", f0=str(deck.frequency), fc=str(deck.frequency / 2))
    ET.SubElement(fdtd, "BoundaryCond", {side: f"PML_{PML}" for side in ("xmin", "xmax", "ymin", "ymax", "zmin", "zmax")})
    structure = ET.SubElement(root, "ContinuousStructure", CoordSystem="0")
    grid = ET.SubElement(structure, "RectilinearGrid", DeltaUnit="0.001", CoordSystem="0")
    for axis, n in zip("XYZ", total):
        ET.SubElement(grid, axis + "Lines").text = ",".join(f"{cell * k:g}" for k in range(n + 1))
    properties = ET.SubElement(structure, "Properties")

    def box(parent, low, high, priority=0):
        primitive = ET.SubElement(parent, "Box", Priority=str(priority))
        for name, corner in (("P1", low), ("P2", high)):
            ET.SubElement(primitive, name, {axis: f"{cell * k:g}" for axis, k in zip("XYZ", corner)})

    unit = lambda axis: ",".join("1" if a == axis else "0" for a in "xyz")
    wave = ET.SubElement(properties, "Excitation", Name="wave", Number="0", Enabled="1", Type="10", Excite=unit(polarization), Frequency=str(deck.frequency), PropDir=unit(towards))
    box(ET.SubElement(wave, "Primitives"), [PML + AROUND] * 3, [n - PML - AROUND for n in total])
    dump = ET.SubElement(properties, "DumpBox", Name="E", DumpType="10", DumpMode="2", FileType="1")
    ET.SubElement(dump, "FD_Samples").text = str(deck.frequency)
    box(ET.SubElement(dump, "Primitives"), [MARGIN] * 3, [MARGIN + n for n in deck.index.shape])
    primitives = []
    for number, material in enumerate(deck.materials):
        element = ET.SubElement(properties, "Material", Name=f"tissue_{number}", Isotropy="1")
        ET.SubElement(element, "Property", Epsilon=str(material["epsilon"]), Kappa=str(material["kappa"]), Density=str(material["density"]))
        primitives.append(ET.SubElement(element, "Primitives"))
    for x, y, first, end, material in runs_of(deck.index):
        box(primitives[material], [MARGIN + x, MARGIN + y, MARGIN + first], [MARGIN + x + 1, MARGIN + y + 1, MARGIN + end], 10)
    ET.ElementTree(root).write(path)


def incident_field(folder, frequency):
    """Spectrum of the incident wave at the frequency, scaled as openEMS scales its dumps."""
    t, signal = np.loadtxt(os.path.join(folder, "et"), comments="%", usecols=(0, 1)).T
    return 2 * (t[1] - t[0]) * abs(np.sum(signal * np.exp(-2j * np.pi * frequency * t)))


def read_field(folder, deck):
    """|E|^2 at the cells' centres; openEMS adds a cell at either end."""
    with h5py.File(os.path.join(folder, "E.h5")) as file:
        field = file["FieldData/FD/f0_real"][()] + 1j * file["FieldData/FD/f0_imag"][()]
        lines = [file["Mesh/" + axis][()] * 1000 for axis in "xyz"]
    squared = (abs(field) ** 2).sum(0).transpose()
    places = [deck.cell * (MARGIN + 0.5 + np.arange(n)) for n in deck.index.shape]
    picked = [np.searchsorted(line, place - deck.cell / 4) for line, place in zip(lines, places)]
    assert all(np.allclose(line[pick], place, atol=deck.cell / 100) for line, pick, place in zip(lines, picked, places))
    return squared[np.ix_(*picked)]


def absorption(deck, polarization, towards, threads):
    """W/m3 at each cell for an incident power density of 1 W/m2."""
    with tempfile.TemporaryDirectory() as folder:
        write_simulation(deck, os.path.join(folder, "simulation.xml"), polarization, towards)
        done = subprocess.run(["openEMS", "simulation.xml", f"--numThreads={threads}"], cwd=folder, capture_output=True, text=True)
        if done.returncode != 0 or not os.path.exists(os.path.join(folder, "E.h5")):
            sys.exit("openEMS failed:\n" + (done.stdout + done.stderr)[-2000:])
        squared = read_field(folder, deck) / incident_field(folder, deck.frequency) ** 2
    per_power = 2 * 376.730313668  # |E|^2 of a wave of 1 W/m2
    return deck.of_cells("kappa") / 2 * squared * per_power


def say(text):
    print("sar_openems.py: " + text, file=sys.stderr)


def result_of(deck, polarization, towards, threads):
    start = time.time()
    density = absorption(deck, polarization, towards, threads)
    volume = (deck.cell / 1000) ** 3
    watts, mass = density * volume, deck.of_cells("density") * volume
    averages, found = peak_sar.average_sar(watts, mass, GRAMS)
    place = np.unravel_index(np.nanargmax(averages), mass.shape)
    count = lambda kind: int((found == kind).sum())
    heavy, without = int((mass >= GRAMS / 1000).sum()), count(peak_sar.WITHOUT)
    if heavy:
        say(f"{heavy} cells weigh {GRAMS} g or more each: averages there are over a part of one cell; make --cell smaller")
    if without:
        say(f"{without} cells have no cube of {GRAMS} g: the body weighs too little beside them")
    return {
        "frequency_hz": deck.frequency,
        "cell_mm": deck.cell,
        "cells": int((deck.index >= 0).sum()),
        "mass_kg": float(mass.sum()),
        "absorbed_w": float(watts.sum()),
        "sar_average_w_per_kg": float(watts.sum() / mass.sum()),
        "sar_peak_10g_w_per_kg": float(averages[place]),
        "sar_peak_found": FOUND[found[place]],
        "cells_valid": count(peak_sar.VALID),
        "cells_used": count(peak_sar.USED),
        "cells_unused": count(peak_sar.UNUSED),
        "cells_without": without,
        "cells_heavier_than_10g": heavy,
        "seconds": round(time.time() - start, 1),
    }


def mie_absorption(radius, material, frequency):
    """Power that a ball takes up from a wave of 1 W/m2."""
    omega = 2 * np.pi * frequency
    m = np.sqrt(material["epsilon"] - 1j * material["kappa"] / (omega * EPS_0)).conjugate()
    x = omega / LIGHT * radius
    n = np.arange(1, int(x + 4 * x ** (1 / 3) + 12))
    psi = lambda z: (z * spherical_jn(n, z), spherical_jn(n, z) + z * spherical_jn(n, z, True))
    (px, dpx), (pm, dpm) = psi(x), psi(m * x)
    h, dh = spherical_jn(n, x) + 1j * spherical_yn(n, x), spherical_jn(n, x, True) + 1j * spherical_yn(n, x, True)
    xi, dxi = x * h, h + x * dh
    a = (m * pm * dpx - px * dpm) / (m * pm * dxi - xi * dpm)
    b = (pm * dpx - m * px * dpm) / (pm * dxi - m * xi * dpm)
    extinction = 2 / x**2 * ((2 * n + 1) * (a + b).real).sum()
    scattering = 2 / x**2 * ((2 * n + 1) * (abs(a) ** 2 + abs(b) ** 2)).sum()
    return (extinction - scattering) * np.pi * radius**2


def result_of_ball(cell, options):
    material = {"name": "muscle-like", "epsilon": 55.0, "kappa": 0.94, "density": 1040.0}
    radius = 60.0
    result = result_of(ball(radius, cell, material, options.frequency), options.polarization, options.towards, options.threads)
    result["absorbed_by_mie_w"] = float(mie_absorption(radius / 1000, material, options.frequency))
    result["difference_percent"] = 100 * (result["absorbed_w"] / result["absorbed_by_mie_w"] - 1)
    return result


def chosen_cells(out, options):
    """A study's cells at one spacing, by one method."""
    with open(os.path.join(out, "cells.json")) as file:
        cells = [cell for cell in json.load(file)["cells"] if "key" in cell]
    there = {cell["method"] for cell in cells}
    options.method = options.method or next((method for method in SOUNDEST if method in there), SOUNDEST[0])
    cells = [cell for cell in cells if cell["method"] == options.method]
    if options.spacing is None and cells:
        options.spacing = min(cell["spacing_mm"] or 0 for cell in cells)
    poses = options.poses and options.poses.split(",")
    chosen = [cell for cell in cells if (cell["spacing_mm"] or 0) == options.spacing and (not poses or cell["pose"] in poses)]
    if not chosen or (poses and len(chosen) < len(poses)):
        sys.exit(f"sar_openems.py: {out}: the study has no such cells: it has by {options.method} " + (", ".join(f"{c['spacing_mm']} mm {c['pose']}" for c in cells) or "none"))
    return chosen


def deck_of_cell(out, cell, options, folder):
    """As `limber convert` writes it, with the study's own table of tissues."""
    place = os.path.join(out, cell["folder"])
    with open(os.path.join(place, "job.json")) as file:
        tissues = json.load(file).get("tissues")
    deck = os.path.join(folder, "deck.xml")
    words = [options.limber, "convert", os.path.join(place, "posed.nrrd"), deck, "--frequency", str(options.frequency)]
    done = subprocess.run(words + (["--tissues", os.path.join(place, tissues)] if tissues else []), capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(done.stderr.strip())
    return read_deck(deck, options.cell)


def sar_of_study(out, options):
    cells = chosen_cells(out, options)
    poses = []
    for cell in cells:
        with tempfile.TemporaryDirectory() as folder:
            deck = deck_of_cell(out, cell, options, folder)
        result = result_of(deck, options.polarization, options.towards, options.threads)
        poses.append({"pose": cell["pose"], "key": cell["key"], **result})
        print(f"{cell['pose']}: {1000 * result['sar_average_w_per_kg']:.2f} mW/kg on average, {1000 * result['sar_peak_10g_w_per_kg']:.1f} over 10 g, {result['seconds']} s", file=sys.stderr)
    return {
        "schema": "limber-sar/2",
        "frequency_hz": options.frequency,
        "cell_mm": poses[0]["cell_mm"],
        "polarization": options.polarization,
        "towards": options.towards,
        "spacing_mm": options.spacing or None,
        "method": options.method,
        "poses": poses,
        "sphere": result_of_ball(poses[0]["cell_mm"], options),
    }


def plot_of(results):
    """Bars of average and peak SAR, a pair a deck, as SVG."""
    kinds = [("sar_average_w_per_kg", "average", "#3FB6A8"), ("sar_peak_10g_w_per_kg", "largest over 10 g", "#B07AD9")]
    most = max(r[key] for r in results.values() for key, _, _ in kinds)
    row, left, width = 58, 150, 420
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {left + width + 110} {row * len(results) + 50}" font-family="Inter, sans-serif" font-size="13">',
             '<text x="10" y="20" font-weight="600">SAR, W/kg for 1 W/m\u00b2</text>']
    for i, (name, result) in enumerate(results.items()):
        top = 36 + row * i
        lines.append(f'<text x="{left - 12}" y="{top + 27}" text-anchor="end">{escape(name)}</text>')
        for k, (key, word, colour) in enumerate(kinds):
            length = width * result[key] / most
            lines.append(f'<rect x="{left}" y="{top + 22 * k}" width="{length:.1f}" height="18" fill="{colour}"/>')
            lines.append(f'<text x="{left + length + 6:.1f}" y="{top + 22 * k + 14}">{result[key]:.4f} {word if i == 0 else ""}</text>')
    return "\n".join(lines + ["</svg>", ""])


def write(path, text):
    with open(path + ".part", "w") as file:
        file.write(text)
    os.replace(path + ".part", path)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["deck", "sphere", "study"])
    parser.add_argument("decks", nargs="*", help="decks, or a study's folder")
    parser.add_argument("--cell", type=float, help="mm (default: the deck's voxels; sphere: 4)")
    parser.add_argument("--polarization", choices="xyz", default="z")
    parser.add_argument("--towards", choices="xyz", default="y")
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--method", help="study: whose bodies (default: finite elements with contact where the study has them, else what comes nearest)")
    parser.add_argument("--spacing", type=float, help="study: of which spacing, mm (default: the finest)")
    parser.add_argument("--poses", help="study: their names, with commas between them (default: all)")
    parser.add_argument("--frequency", type=float, default=900e6, help="study and sphere, Hz (default: 900e6)")
    parser.add_argument("--limber", default="limber", help="study: the program that converts (default: limber)")
    parser.add_argument("-o", "--output", help="default, for a study: OUT/sar.json")
    parser.add_argument("--plot", help="SVG of average and peak SAR by deck")
    options = parser.parse_args()
    if options.polarization == options.towards:
        parser.error("a wave is not polarized along its way")
    if options.what == "deck" and not options.decks:
        parser.error("name a deck: limber convert POSED.nrrd DECK.xml --frequency 900e6")
    if options.what == "study" and len(options.decks) != 1:
        parser.error("name the folder of one study")
    if options.what == "study" and not options.output:
        options.output = os.path.join(options.decks[0], "sar.json")
    if not options.output:
        parser.error("say where to: -o SAR.json")
    if options.cell is not None and not 0.5 <= options.cell <= 20:
        parser.error("--cell is from 0.5 to 20 mm")
    if shutil.which("openEMS") is None:
        sys.exit("sar_openems.py: openEMS is not installed: Debian's package is openems")
    if options.what == "sphere":
        result = result_of_ball(options.cell or 4, options)
    elif options.what == "study":
        result = sar_of_study(options.decks[0], options)
    else:
        result = {os.path.splitext(os.path.basename(d))[0]: result_of(read_deck(d, options.cell), options.polarization, options.towards, options.threads) for d in options.decks}
    write(options.output, json.dumps(result, indent=1) + "\n")
    if options.plot and options.what == "deck":
        write(options.plot, plot_of(result))
    print(json.dumps(result, indent=1))
    checked = {"deck": None, "sphere": result, "study": result.get("sphere")}[options.what]
    if checked and abs(checked["difference_percent"]) > 10:
        sys.exit(1)


if __name__ == "__main__":
    main()
