// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes pictures as TIFF 6.0 (Adobe, 1992), which journals accept: 8 bits per channel, in strips that are compressed
// by deflate with horizontal differences (Adobe's supplement 2 of 2002). The file states the resolution.
#pragma once

#include "render/image_io.h"

namespace limber::render {

// Returns the bytes of a TIFF file with the channels red, green and blue, and alpha if any pixel is not opaque.
std::string tiff_of(const Image& image, double dots_per_inch);

}  // namespace limber::render
