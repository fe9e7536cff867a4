// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/label_sampler.h"

#include <array>
#include <cmath>

namespace limber {

namespace {
// The labels of the eight voxels around a point with their trilinear shares; the nearest voxel's label comes first, so
// that it wins a tie.
struct Shares {
  std::array<Label, 8> label;
  std::array<double, 8> share;
  int count = 0;

  void add(Label l, double s) {
    for (int i = 0; i < count; ++i)
      if (label[i] == l) {
        share[i] += s;
        return;
      }
    label[count] = l;
    share[count++] = s;
  }
  Label largest() const {
    int best = 0;
    for (int i = 1; i < count; ++i)
      if (share[i] > share[best]) best = i;
    return count ? label[best] : Label{0};
  }
};

template <class Allowed>
Label largest_share(const LabelVolume& volume, const glm::dvec3& point, const Allowed& allowed) {
  const glm::dvec3 low = glm::floor(point), f = point - low;
  const glm::ivec3 v(low), near(f.x >= 0.5, f.y >= 0.5, f.z >= 0.5);
  Shares shares;
  for (int k = 0; k < 8; ++k) {
    const glm::ivec3 corner = near ^ glm::ivec3(k & 1, k >> 1 & 1, k >> 2);
    const Label label = volume.at_or_air(v + corner);
    if (label && allowed(label))
      shares.add(label, (corner.x ? f.x : 1 - f.x) * (corner.y ? f.y : 1 - f.y) * (corner.z ? f.z : 1 - f.z));
  }
  return shares.largest();
}
}  // namespace

LabelSampler::LabelSampler(const LabelVolume& volume) : volume_(&volume) {}

Label LabelSampler::nearest(const glm::dvec3& point) const {
  return volume_->at_or_air(glm::ivec3(glm::floor(point + 0.5)));
}

Label LabelSampler::tissue(const glm::dvec3& point) const {
  return nearest(point) ? largest_share(*volume_, point, [](Label) { return true; }) : Label{0};
}

Label LabelSampler::tissue(const glm::dvec3& point, const LabelSet& allowed) const {
  return largest_share(*volume_, point, [&](Label label) { return allowed[label] != 0; });
}

}  // namespace limber
