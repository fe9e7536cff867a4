#!/usr/bin/env python3
# SPDX-License-Identifier: AGPL-3.0-or-later
"""Makes the fonts that a study's page carries, from those of Debian's fonts-inter and fonts-jetbrains-mono.

    subset_fonts.py FOLDER

Needs fonttools and python3-brotli. Only the letters that pages use are kept. Inter gets TrueType outlines, since browsers
print the cubic ones of its OpenType file as Type 3 fonts, which journals refuse. The fonts stay under the SIL Open Font License
1.1, whose notice is in the files.
"""
import sys

from fontTools import subset
from fontTools.pens.cu2quPen import Cu2QuPen
from fontTools.pens.ttGlyphPen import TTGlyphPen
from fontTools.ttLib import TTFont, newTable

CODE = [*range(0x20, 0x7F), *range(0xA0, 0x100), 0x2026, 0x2212]
TEXT = [*range(0x20, 0x7F), *range(0xA0, 0x180), *range(0x391, 0x3CA), 0x2002, 0x2009, 0x200A, *range(0x2010, 0x2015), 0x2018,
        0x2019, 0x201C, 0x201D, 0x2022, 0x2026, 0x202F, 0x2032, 0x2033, 0x20AC, 0x2192, 0x2212, 0x2248, 0x2264, 0x2265, 0x2713, 0x2717]
MAXP = ("maxTwilightPoints maxStorage maxFunctionDefs maxInstructionDefs maxStackElements maxSizeOfInstructions maxComponentElements "
        "maxPoints maxContours maxCompositePoints maxCompositeContours maxComponentDepth").split()


def give_truetype_outlines(font):
    order, source, glyphs = font.getGlyphOrder(), font.getGlyphSet(), {}
    for name in order:
        pen = TTGlyphPen(source)
        source[name].draw(Cu2QuPen(pen, 1.0, reverse_direction=True))
        glyphs[name] = pen.glyph()
    font["loca"], table = newTable("loca"), newTable("glyf")
    table.glyphOrder, table.glyphs = order, glyphs
    font["glyf"] = table
    for name in order:
        table[name].recalcBounds(table)
        font["hmtx"][name] = (font["hmtx"][name][0], getattr(table[name], "xMin", 0))
    del font["CFF "]
    font["maxp"].tableVersion, font["maxp"].maxZones = 0x00010000, 1
    for field in MAXP:
        setattr(font["maxp"], field, 0)
    font["post"].formatType, font.sfntVersion = 3.0, "\000\001\000\000"


def make(source, out, letters, features):
    font = TTFont(source)
    options = subset.Options(layout_features=features, name_IDs=[0, 1, 2, 3, 4, 5, 6, 13, 14, 16, 17], hinting=False,
                             notdef_outline=True, desubroutinize=True)
    subsetter = subset.Subsetter(options)
    subsetter.populate(unicodes=letters)
    subsetter.subset(font)
    if "CFF " in font:
        give_truetype_outlines(font)
    font.flavor = "woff2"
    font.save(out)


for face in ("Regular", "SemiBold"):
    make(f"/usr/share/fonts/opentype/inter/Inter-{face}.otf", f"{sys.argv[1]}/Inter-{face}.woff2", TEXT,
         ["kern", "tnum", "mark", "ccmp", "locl"])
make("/usr/share/fonts/truetype/jetbrains-mono/JetBrainsMono-Regular.ttf", f"{sys.argv[1]}/JetBrainsMono-Regular.woff2", CODE, [])
