// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/label_sampler.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <map>

namespace limber {

namespace {
// Share of the eight voxels' mean that is subtracted from each membership (an unsharp mask). The volumes of tissues are
// preserved best at 0.15 to 0.2. The Dice coefficient of large tissues is highest at 0. At 0.1, volumes and Dice
// coefficient are both close to their best. With any value below 4/3, a point at a voxel's centre gets the label of
// this voxel.
constexpr double kSharpening = 0.1;

// Returns the value rounded down. std::floor would be a function call where the compiler may not use the processor's
// rounding instruction.
int round_down(double value) {
  const int whole = static_cast<int>(value);
  return whole - (value < whole);
}

double hermite(double f) { return f * f * (3 - 2 * f); }
}  // namespace

// The eight voxels around a point, numbered 0 to 7. Bits 0, 1 and 2 of a voxel's number tell whether it is on the upper
// side along x, y and z.
struct LabelSampler::Neighbours {
  std::array<Label, 8> label;
  glm::ivec3 low;
  // place() sets the next two members, the point's position among the eight voxels.
  glm::dvec3 fraction;  // position of the point between the lower and the upper voxels along each axis, [0, 1)
  int nearest;          // corner number of the voxel nearest to the point

  const glm::dvec3& place(const glm::dvec3& point) {
    fraction = point - glm::dvec3(low);
    nearest = (fraction.x >= 0.5) | (fraction.y >= 0.5) << 1 | (fraction.z >= 0.5) << 2;
    return fraction;
  }

  bool uniform() const {
    std::uint64_t half[2];
    std::memcpy(half, label.data(), sizeof half);
    return half[0] == half[1] && half[0] == label[0] * std::uint64_t{0x0001000100010001};
  }

  // Returns the memberships of the eight voxels' labels, without those that `allowed` refuses. The nearest voxel's
  // label is first in the list, so that it wins a tie.
  template <class Allowed>
  Memberships memberships(const Allowed& allowed) const {
    const double x[] = {1 - hermite(fraction.x), hermite(fraction.x)};
    const double y[] = {1 - hermite(fraction.y), hermite(fraction.y)};
    const double z[] = {1 - hermite(fraction.z), hermite(fraction.z)};
    Memberships found;
    for (int k = 0; k < 8; ++k) {
      const int corner = k ^ nearest;
      if (!allowed(label[corner])) continue;
      const double share = x[corner & 1] * y[corner >> 1 & 1] * z[corner >> 2] - kSharpening / 8;
      int place = 0;
      while (place < found.count && found.label[place] != label[corner]) ++place;
      if (place == found.count) {
        found.label[place] = label[corner];
        found.share[found.count++] = 0;
      }
      found.share[place] += share;
    }
    return found;
  }

  // Returns the label with the largest membership among the labels that `allowed` accepts; 0 if it accepts none of the
  // eight.
  template <class Allowed>
  Label largest_membership(const Allowed& allowed) const {
    const Memberships found = memberships(allowed);
    int best = 0;
    for (int i = 1; i < found.count; ++i)
      if (found.share[i] > found.share[best]) best = i;
    return found.count ? found.label[best] : Label{0};
  }
};

LabelSampler::LabelSampler(const LabelVolume& volume)
    : volume_(&volume),
      row_(volume.grid.size.x),
      slice_(std::int64_t{volume.grid.size.x} * volume.grid.size.y) {}

// Finds the eight voxels around the point. Returns false when the point is so far outside the grid (or not a number)
// that all eight are air.
inline bool LabelSampler::neighbours(const glm::dvec3& point, Neighbours& out) const {
  const glm::ivec3 size = volume_->grid.size;
  const bool near_grid =
      point.x >= -1 && point.y >= -1 && point.z >= -1 && point.x < size.x && point.y < size.y && point.z < size.z;
  if (!near_grid) return false;
  const glm::ivec3 low(round_down(point.x), round_down(point.y), round_down(point.z));
  out.low = low;
  const bool inside =
      low.x >= 0 && low.y >= 0 && low.z >= 0 && low.x + 1 < size.x && low.y + 1 < size.y && low.z + 1 < size.z;
  if (inside) {
    const Label* at = volume_->voxels.data() + volume_->grid.index(low);
    const Label* above = at + slice_;
    const Label* pair[] = {at, at + row_, above, above + row_};
    for (int p = 0; p < 4; ++p) std::memcpy(&out.label[2 * p], pair[p], 2 * sizeof(Label));
  } else {
    for (int k = 0; k < 8; ++k) out.label[k] = volume_->at_or_air(low + glm::ivec3(k & 1, k >> 1 & 1, k >> 2));
  }
  return true;
}

Label LabelSampler::nearest(const glm::dvec3& point) const {
  const glm::dvec3 shifted = point + 0.5;
  const glm::ivec3 size = volume_->grid.size;
  const bool inside = shifted.x >= 0 && shifted.y >= 0 && shifted.z >= 0 && shifted.x < size.x && shifted.y < size.y &&
                      shifted.z < size.z;
  return inside ? volume_->at(glm::ivec3(shifted)) : Label{0};
}

Label LabelSampler::tissue(const glm::dvec3& point) const {
  // A point exactly at a voxel's centre gets the label of this voxel. This case is frequent, since a pose does not
  // move all tissue.
  const glm::ivec3 size = volume_->grid.size;
  if (point.x >= 0 && point.y >= 0 && point.z >= 0 && point.x < size.x && point.y < size.y && point.z < size.z)
    if (const glm::ivec3 voxel(point); glm::dvec3(voxel) == point) return volume_->at(voxel);
  Neighbours around;
  if (!neighbours(point, around)) return 0;
  if (around.uniform()) return around.label[0];
  const glm::dvec3 f = around.place(point);
  const Label nearest = around.label[around.nearest];
  if (nearest == 0 || f == glm::dvec3(0)) return nearest;
  return around.largest_membership([](Label label) { return label != 0; });
}

Label LabelSampler::tissue(const glm::dvec3& point, const LabelSet& allowed) const {
  Neighbours around;
  if (!neighbours(point, around)) return 0;
  around.place(point);
  return around.largest_membership([&](Label label) { return label != 0 && allowed[label] != 0; });
}

LabelSampler::Memberships LabelSampler::memberships(const glm::dvec3& point, const LabelSet& allowed) const {
  Neighbours around;
  if (!neighbours(point, around)) return {};
  around.place(point);
  return around.memberships([&](Label label) { return label != 0 && allowed[label] != 0; });
}

Label LabelSampler::nearest_of(const glm::dvec3& point, const LabelSet& allowed, int reach) const {
  const glm::ivec3 size = volume_->grid.size;
  const glm::dvec3 held = glm::clamp(point, glm::dvec3(-1), glm::dvec3(size));
  const glm::ivec3 centre(round_down(held.x + 0.5), round_down(held.y + 0.5), round_down(held.z + 0.5));
  Label best = 0;
  double nearest = std::numeric_limits<double>::infinity();
  // Searches the cubic shells of voxels around the centre from the inside out. A voxel of shell s is at least s - 0.5
  // voxels from the point.
  for (int shell = 0; shell <= reach; ++shell) {
    if (best && (shell - 0.5) * (shell - 0.5) > nearest) break;
    for (int z = -shell; z <= shell; ++z)
      for (int y = -shell; y <= shell; ++y) {
        const bool face = std::abs(z) == shell || std::abs(y) == shell;
        for (int x = -shell; x <= shell; x += face || shell == 0 ? 1 : 2 * shell) {
          const glm::ivec3 v = centre + glm::ivec3(x, y, z);
          const Label label = volume_->at_or_air(v);
          if (!label || !allowed[label]) continue;
          const glm::dvec3 away = glm::dvec3(v) - held;
          const double squared = glm::dot(away, away);
          if (squared < nearest) {
            nearest = squared;
            best = label;
          }
        }
      }
  }
  return best;
}

Label LabelSampler::prevailing(const glm::dvec3& point, const LabelSet& allowed, int reach) const {
  const glm::dvec3 held = glm::clamp(point, glm::dvec3(-1), glm::dvec3(volume_->grid.size));
  const glm::ivec3 centre(round_down(held.x + 0.5), round_down(held.y + 0.5), round_down(held.z + 0.5));
  std::map<Label, int> voxels;
  int last = reach;
  for (int shell = 0; shell <= last; ++shell) {
    const bool none_before = voxels.empty();
    for (int z = -shell; z <= shell; ++z)
      for (int y = -shell; y <= shell; ++y) {
        const bool face = std::abs(z) == shell || std::abs(y) == shell;
        for (int x = -shell; x <= shell; x += face || shell == 0 ? 1 : 2 * shell) {
          const Label label = volume_->at_or_air(centre + glm::ivec3(x, y, z));
          if (label && allowed[label]) ++voxels[label];
        }
      }
    if (none_before && !voxels.empty()) last = shell + 2;
  }
  Label best = 0;
  for (const auto& [label, count] : voxels)
    if (!best || count > voxels[best]) best = label;
  return best;
}

}  // namespace limber
