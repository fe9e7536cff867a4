// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/scene/grey_transfer.h"

#include <algorithm>
#include <vector>

namespace limber::render {

namespace {

// A value of the image with its colour and opacity. Between two knots, colour and opacity are interpolated linearly.
struct Knot {
  double value;
  glm::vec3 colour;
  float opacity;  // opacity of a layer one millimetre thick, [0, 1]
};

constexpr glm::vec3 kSkinColour{0.88f, 0.69f, 0.58f}, kFleshColour{0.72f, 0.26f, 0.20f},
    kFatColour{0.93f, 0.80f, 0.55f}, kSpongyBone{0.86f, 0.73f, 0.56f}, kDenseBone{0.96f, 0.92f, 0.83f};

std::vector<Knot> knots_of(const ShownGrey& shown) {
  switch (shown.rendering) {
    case GreyRendering::Bone:
      return {{130, kSpongyBone, 0}, {220, kSpongyBone, 0.25f}, {400, kDenseBone, 0.7f}, {1200, kDenseBone, 0.95f}};
    case GreyRendering::Muscle:
      return {{-20, kFatColour, 0},     {20, kFleshColour, 0.05f}, {70, kFleshColour, 0.22f},
              {140, kSpongyBone, 0.2f}, {300, kDenseBone, 0.7f},   {1200, kDenseBone, 0.95f}};
    case GreyRendering::Skin: return {{-450, kSkinColour, 0}, {-250, kSkinColour, 0.6f}, {1200, kSkinColour, 0.9f}};
    case GreyRendering::Window:
    case GreyRendering::Maximum: break;
  }
  const double half = std::max(shown.width, 1e-6) / 2;
  return {{shown.level - half, glm::vec3(0), 0}, {shown.level + half, glm::vec3(1), 0.35f}};
}

}  // namespace

GreyTransfer transfer_of(const ShownGrey& shown) {
  const std::vector<Knot> knots = knots_of(shown);
  GreyTransfer transfer{knots.front().value, knots.back().value, {}};
  std::size_t next = 1;
  for (int i = 0; i < GreyTransfer::kSamples; ++i) {
    const double value = transfer.low + (transfer.high - transfer.low) * i / (GreyTransfer::kSamples - 1);
    while (next + 1 < knots.size() && value > knots[next].value) ++next;
    const Knot &a = knots[next - 1], &b = knots[next];
    const float t = static_cast<float>(std::clamp((value - a.value) / (b.value - a.value), 0.0, 1.0));
    transfer.samples[static_cast<std::size_t>(i)] =
        glm::vec4(glm::mix(a.colour, b.colour, t), glm::mix(a.opacity, b.opacity, t));
  }
  return transfer;
}

}  // namespace limber::render
