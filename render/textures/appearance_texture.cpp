// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/textures/appearance_texture.h"

#include <algorithm>
#include <cmath>

#include <epoxy/gl.h>

namespace limber::render {

namespace {

constexpr size_t kLabels = 65536;
constexpr float kOpaque = 0.995f;

std::uint16_t in_255(float value) {
  return static_cast<std::uint16_t>(std::lround(std::clamp(value, 0.0f, 1.0f) * 255));
}

bool is_seen(const LabelLook& look, Display display) {
  return look.visible && (display != Display::Tissue || look.opacity > 0);
}

// Returns, for each label, the index of the last layer (set of labels) that contains it.
std::vector<int> last_layers(const LabelLooks& looks, Display display, const std::vector<float>& exposure) {
  std::vector<int> layer(kLabels, 0);
  const size_t count = std::min(looks.size(), kLabels);
  if (display == Display::XRay)
    for (size_t label = 1; label < count; ++label) layer[label] = looks[label].bone;
  if (display != Display::Tissue) return layer;

  // Transparent labels by opacity, the most transparent first; at equal opacity, outer labels first.
  std::vector<size_t> clear;
  bool any_opaque = false;
  for (size_t label = 1; label < count; ++label) {
    if (!is_seen(looks[label], display)) continue;
    if (looks[label].opacity < kOpaque) clear.push_back(label);
    else any_opaque = true;
  }
  std::stable_sort(clear.begin(), clear.end(), [&](size_t a, size_t b) {
    if (looks[a].opacity != looks[b].opacity) return looks[a].opacity < looks[b].opacity;
    return exposure[a] > exposure[b];
  });
  // Each transparent label gets its own layer. If there are more of these labels than layers, they are spread evenly
  // over the layers.
  const size_t room = kMostLayers - (any_opaque ? 1 : 0), used = std::min(room, clear.size());
  for (size_t i = 0; i < clear.size(); ++i) layer[clear[i]] = static_cast<int>(i * used / clear.size());
  for (size_t label = 1; label < count; ++label)
    if (looks[label].opacity >= kOpaque) layer[label] = static_cast<int>(used);
  return layer;
}

}  // namespace

std::vector<LabelSet> layers_of(const LabelLooks& looks, Display display, const std::vector<float>& exposure) {
  const std::vector<int> last = last_layers(looks, display, exposure);
  std::vector<LabelSet> layers(display == Display::XRay ? 2 : 1, LabelSet(kLabels));
  for (size_t label = 1; label < std::min(looks.size(), kLabels); ++label) {
    if (!is_seen(looks[label], display)) continue;
    const auto count = static_cast<size_t>(last[label]) + 1;
    if (layers.size() < count) layers.resize(count, LabelSet(kLabels));
    for (size_t layer = 0; layer < count; ++layer) layers[layer][label] = 1;
  }
  return layers;
}

LooksTexture::LooksTexture(const LabelLooks& looks, Display display, const std::vector<float>& exposure)
    : texture_(gl::Texture::create()),
      layers_(layers_of(looks, display, exposure)) {
  const std::vector<int> last = last_layers(looks, display, exposure);
  std::vector<glm::u16vec4> texels(kLabels, glm::u16vec4(0));
  for (size_t label = 1; label < std::min(looks.size(), kLabels); ++label) {
    const LabelLook& look = looks[label];
    if (!is_seen(look, display)) continue;
    const int opacity = display == Display::Tissue ? in_255(look.opacity) : 255;
    texels[label] = {in_255(look.colour.r), in_255(look.colour.g), in_255(look.colour.b),
                     static_cast<std::uint16_t>((last[label] + 1) | opacity << 3)};
  }

  glBindTexture(GL_TEXTURE_2D, texture_.name());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA16UI, 256, 256, 0, GL_RGBA_INTEGER, GL_UNSIGNED_SHORT, texels.data());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

}  // namespace limber::render
