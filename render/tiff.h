// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes pictures as TIFF 6.0 (Adobe, 1992), as journals take them: 8 bits a channel, packed in strips by deflate with
// horizontal differences (Adobe's supplement 2 of 2002), with the resolution in the file.
#pragma once

#include "render/image_io.h"

namespace limber::render {

// Returns the bytes of a TIFF file: red, green and blue, and the opacity only if a pixel is not opaque.
std::string tiff_of(const Image& image, double dots_per_inch);

}  // namespace limber::render
