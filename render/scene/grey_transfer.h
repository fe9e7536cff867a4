// SPDX-License-Identifier: AGPL-3.0-or-later
// The transfer functions of a grey image's 3D rendering, which give each value a colour and an opacity. The functions
// for CT are defined in Hounsfield units (air -1000, fat about -100, water 0, muscle 50, bone from 200 to 2000).
#pragma once

#include <array>

#include <glm/glm.hpp>

#include "render/scene/scene.h"

namespace limber::render {

struct GreyTransfer {
  static constexpr int kSamples = 256;
  double low = 0, high = 1;  // the image values of the first and the last sample
  // Colour (sRGB, not premultiplied) and opacity of a layer one millimetre thick, at evenly spaced values. Values
  // below `low` are transparent; values above `high` have the colour and opacity of `high`.
  std::array<glm::vec4, kSamples> samples;
};
GreyTransfer transfer_of(const ShownGrey& shown);

}  // namespace limber::render
