// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/label_edit/split_label.h"

#include <array>
#include <cmath>

#include "core/base/error.h"

namespace limber {

namespace {

// The plane of a cut, which contains the drawn line and the direction of sight, and the strip of the plane that cuts:
// the part between the ends of the line. World coordinates.
class Knife {
 public:
  explicit Knife(const LabelCut& cut) : from_(cut.from), length_(glm::distance(cut.from, cut.to)) {
    const glm::dvec3 line = cut.to - cut.from;
    const glm::dvec3 across = line - glm::dot(line, cut.sight) * cut.sight;
    if (glm::length(across) < 1e-9) throw Error("the cut has no length", "Split", "draw a line across the tissue");
    length_ = glm::length(across);
    along_ = across / length_;
    normal_ = glm::normalize(glm::cross(along_, cut.sight));
  }
  double side(const glm::dvec3& point) const { return glm::dot(point - from_, normal_); }
  // Returns whether the line segment between two points on different sides of the plane passes through the strip.
  bool parts(const glm::dvec3& a, const glm::dvec3& b) const {
    const double side_a = side(a), side_b = side(b);
    if ((side_a > 0) == (side_b > 0)) return false;
    const glm::dvec3 meet = a + (b - a) * (side_a / (side_a - side_b));
    const double at = glm::dot(meet - from_, along_);
    return at >= 0 && at <= length_;
  }

 private:
  glm::dvec3 from_, along_{0}, normal_{0};
  double length_;
};

constexpr std::array<glm::ivec3, 6> kFaces = {glm::ivec3(1, 0, 0),  glm::ivec3(0, 1, 0),  glm::ivec3(0, 0, 1),
                                              glm::ivec3(-1, 0, 0), glm::ivec3(0, -1, 0), glm::ivec3(0, 0, -1)};

// The voxels of the label in a box, and the side of the cut from which each was reached.
struct Parts {
  const LabelVolume& volume;
  Label label;
  const Knife& knife;
  VoxelBox box;
  AffineTransform to_world;
  // For each voxel of the box, the side of the cut from which it was reached, 1 or 2; 0: not reached.
  std::vector<std::uint8_t> side;

  bool holds(const glm::ivec3& v) const { return box.contains(v) && volume.at(v) == label; }
  bool joined(const glm::ivec3& a, const glm::ivec3& b) const {
    return !knife.parts(to_world * glm::dvec3(a), to_world * glm::dvec3(b));
  }
  std::uint8_t& side_of(const glm::ivec3& v) { return side[static_cast<std::size_t>(box.index(v))]; }

  // Marks all voxels of the label that are connected to the seeds `open`, and returns their number. Throws Error if one
  // of them already has the mark of the other side.
  std::int64_t flood(std::vector<glm::ivec3> open, std::uint8_t mark) {
    std::int64_t count = 0;
    std::erase_if(open, [&](const glm::ivec3& v) {
      const bool again = side_of(v) == mark;
      if (!again) take(v, mark), ++count;
      return again;
    });
    while (!open.empty()) {
      const glm::ivec3 here = open.back();
      open.pop_back();
      for (const glm::ivec3& step : kFaces) {
        const glm::ivec3 there = here + step;
        if (!holds(there) || side_of(there) == mark || !joined(here, there)) continue;
        take(there, mark);
        ++count;
        open.push_back(there);
      }
    }
    return count;
  }
  void take(const glm::ivec3& v, std::uint8_t mark) {
    if (side_of(v) != 0)
      throw Error("the cut does not divide the tissue", "it is still connected around the line",
                  "draw the line across the whole tissue");
    side_of(v) = mark;
  }
};

}  // namespace

LabelChange split_label(const LabelVolume& volume, Label label, const LabelCut& cut, Label into) {
  const Knife knife(cut);
  const VoxelBox box = label_box(volume, label);
  Parts parts{volume, label, knife, box, world_from_voxel(volume.grid), {}};
  parts.side.resize(static_cast<std::size_t>(box.voxel_count()));
  std::array<std::vector<glm::ivec3>, 2> seeds;
  for (int z = 0; z < box.size.z; ++z)
    for (int y = 0; y < box.size.y; ++y)
      for (int x = 0; x < box.size.x; ++x) {
        const glm::ivec3 here = box.lowest + glm::ivec3(x, y, z);
        if (volume.at(here) != label) continue;
        for (int axis = 0; axis < 3; ++axis) {
          const glm::ivec3 there = here + kFaces[static_cast<std::size_t>(axis)];
          if (!parts.holds(there) || parts.joined(here, there)) continue;
          const bool beyond = knife.side(parts.to_world * glm::dvec3(here)) > 0;
          seeds[beyond ? 1 : 0].push_back(here);
          seeds[beyond ? 0 : 1].push_back(there);
        }
      }
  if (seeds[0].empty())
    throw Error("the line does not cut the tissue", "Split", "draw the line across the selected tissue");
  const std::int64_t first = parts.flood(std::move(seeds[0]), 1), second = parts.flood(std::move(seeds[1]), 2);
  const std::uint8_t smaller = first < second ? 1 : 2;
  return change_by_rows(box, [&](int y, int z, LabelChange& change) {
    for (int x = box.lowest.x; x < box.lowest.x + box.size.x; ++x)
      if (parts.side[static_cast<std::size_t>(box.index({x, y, z}))] == smaller)
        change.add(volume.grid.index({x, y, z}), label, into);
  });
}

}  // namespace limber
