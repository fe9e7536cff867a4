// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds which tissues a picture shows, for the legend of colours.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "core/study/picture.h"

namespace limber {

// The tissues that a figure's pictures show: name and sRGB colour, by the value of the tissue's voxels in files.
struct ShownTissue {
  std::string name;
  glm::u8vec3 colour{0};
};
using TissueLegend = std::map<double, ShownTissue>;

// The part of a body that a picture shows: the slice in the frame's plane, the body's surface as the viewer sees it, or
// the surface that remains when all tissue between viewer and plane is removed.
enum class ShownPart { Slice, Surface, CutSurface };

// Adds the tissues that the picture shows. To save time, only every fourth pixel in each direction is examined.
void add_shown(const LabelVolume& volume, const TissueTable& tissues, PictureFrame frame, ShownPart part,
               TissueLegend& legend);

// Returns the legend as a paragraph of HTML; empty if the figure shows no tissue.
std::string html_of(const TissueLegend& legend);

}  // namespace limber
