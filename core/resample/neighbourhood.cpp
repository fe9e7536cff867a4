// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/neighbourhood.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace limber {

namespace {

constexpr int kReach = 8;  // radius within which nearest_voxel() searches, voxels

// A set of voxels in the 3^3 cube around a voxel is stored as 27 bits, x fastest; bit 13 is the central voxel.
constexpr unsigned kCentre = 1u << 13;

// Returns, for each voxel of the 3^3 cube, the bit mask of the cube's voxels that are equal or 26-adjacent to it.
const std::array<unsigned, 27>& beside() {
  static const std::array<unsigned, 27> all = [] {
    std::array<unsigned, 27> places{};
    for (int a = 0; a < 27; ++a)
      for (int b = 0; b < 27; ++b)
        if (std::abs(a % 3 - b % 3) <= 1 && std::abs(a / 3 % 3 - b / 3 % 3) <= 1 && std::abs(a / 9 - b / 9) <= 1)
          places[a] |= 1u << b;
    return places;
  }();
  return all;
}

bool bits_hang_together(unsigned places) {
  places &= ~kCentre;
  unsigned reached = places & -places;
  for (unsigned fresh = reached; fresh;) {
    unsigned next = 0;
    for (; fresh; fresh &= fresh - 1) next |= beside()[std::countr_zero(fresh)];
    fresh = next & places & ~reached;
    reached |= fresh;
  }
  return places && reached == places;
}

// Returns, for each voxel of the 3^3 cube, the bit mask of the cube's voxels that share a face with it. The cube's
// corners and centre have an empty mask and are in no mask.
const std::array<unsigned, 27>& at_faces() {
  static const std::array<unsigned, 27> all = [] {
    const auto from_middle = [](int k) { return std::abs(k % 3 - 1) + std::abs(k / 3 % 3 - 1) + std::abs(k / 9 - 1); };
    std::array<unsigned, 27> places{};
    for (int a = 0; a < 27; ++a)
      for (int b = 0; b < 27; ++b) {
        const int apart = std::abs(a % 3 - b % 3) + std::abs(a / 3 % 3 - b / 3 % 3) + std::abs(a / 9 - b / 9);
        const bool kept = from_middle(a) % 3 != 0 && from_middle(b) % 3 != 0;
        if (kept && apart == 1) places[a] |= 1u << b;
      }
    return places;
  }();
  return all;
}

constexpr unsigned kFaces = 1u << 4 | 1u << 10 | 1u << 12 | 1u << 14 | 1u << 16 | 1u << 22;

// Returns true if at least one face neighbour of the cube's central voxel is marked, and if paths of marked voxels join
// all marked face neighbours. Steps of a path go through faces, over voxels that share a face or an edge with the
// central voxel.
bool faces_hang_together(unsigned places) {
  const unsigned faces = places & kFaces;
  unsigned reached = faces & -faces;
  for (unsigned fresh = reached; fresh;) {
    unsigned next = 0;
    for (; fresh; fresh &= fresh - 1) next |= at_faces()[std::countr_zero(fresh)];
    fresh = next & places & ~reached;
    reached |= fresh;
  }
  return faces && (faces & ~reached) == 0;
}

// Calls body(index, label) for the 3^3 voxels around a voxel, x fastest; voxels outside the grid are air.
template <class Body>
void for_each_around(const LabelView& volume, const glm::ivec3& voxel, const Body& body) {
  const LabelView::Centre centre = volume.centre(voxel);
  for (int k = 0; k < 27; ++k) {
    const glm::ivec3 step(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
    body(k,
         centre.at ? centre.at[step.x + centre.row * step.y + centre.slice * step.z] : volume.at_or_air(voxel + step));
  }
}

}  // namespace

const std::array<glm::ivec3, 26>& neighbours() {
  static const std::array<glm::ivec3, 26> all = [] {
    std::array<glm::ivec3, 26> steps;
    int count = 0;
    for (int i = 0; i < 27; ++i)
      if (i != 13) steps[count++] = {i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1};
    return steps;
  }();
  return all;
}

std::int64_t run_at(const Components& components, const LabelView& volume, const glm::ivec3& v) {
  const std::int64_t row = v.y + std::int64_t{volume.grid.size.y} * v.z;
  const auto begin = components.runs.begin() + components.first_run[row],
             end = components.runs.begin() + components.first_run[row + 1];
  const auto run = std::partition_point(begin, end, [&](const Components::Run& r) { return r.end <= v.x; });
  return run - components.runs.begin();
}

std::optional<glm::ivec3> nearest_voxel(const LabelView& volume, Label label, const glm::dvec3& point) {
  const glm::ivec3 centre(glm::floor(point + 0.5));
  const glm::dvec3 spacing = volume.grid.spacing;
  const double least = std::min({spacing.x, spacing.y, spacing.z});
  double nearest = INFINITY;  // squared distance to the nearest voxel found so far, mm2
  glm::ivec3 found(0);
  // Shell n holds the voxels n steps from the central voxel. Each of them is at least n - 0.5 voxels away from `point`.
  for (int shell = 0; shell <= kReach && least * (shell - 0.5) < std::sqrt(nearest); ++shell)
    for (int z = -shell; z <= shell; ++z)
      for (int y = -shell; y <= shell; ++y) {
        const bool face = std::abs(z) == shell || std::abs(y) == shell;
        for (int x = -shell; x <= shell; x += face || shell == 0 ? 1 : 2 * shell) {
          const glm::ivec3 v = centre + glm::ivec3(x, y, z);
          if (volume.at_or_air(v) != label) continue;
          const glm::dvec3 away = (glm::dvec3(v) - point) * spacing;
          if (const double squared = glm::dot(away, away); squared < nearest) {
            nearest = squared;
            found = v;
          }
        }
      }
  return nearest < INFINITY ? std::optional(found) : std::nullopt;
}

int nearest_component(const Components& components, const LabelView& volume, Label label, const glm::dvec3& point) {
  const auto found = nearest_voxel(volume, label, point);
  return found ? component_at(components, volume, *found) : -1;
}

bool is_connected_26(const std::array<bool, 27>& marked) {
  unsigned places = 0;
  for (int k = 0; k < 27; ++k) places |= unsigned{marked[k]} << k;
  return bits_hang_together(places);
}

bool is_simple_point(const LabelView& volume, const glm::ivec3& voxel) {
  const Label own = volume.at(voxel);
  unsigned same = 0;
  for_each_around(volume, voxel, [&](int k, Label label) { same |= unsigned{label == own} << k; });
  return bits_hang_together(same);
}

bool can_join(const LabelView& volume, const glm::ivec3& voxel, Label label) {
  unsigned same = 0;
  for_each_around(volume, voxel, [&](int k, Label there) { same |= unsigned{there == label} << k; });
  return bits_hang_together(same);
}

bool air_can_change(const LabelView& volume, const glm::ivec3& voxel) {
  unsigned air = 0;
  for_each_around(volume, voxel, [&](int k, Label label) { air |= unsigned{label == 0} << k; });
  return faces_hang_together(air) && bits_hang_together(~air & ((1u << 27) - 1));
}

bool is_enclosed(const LabelView& volume, const glm::ivec3& voxel) {
  const Label own = volume.at(voxel);
  bool same = true;
  for_each_around(volume, voxel, [&](int, Label label) { same &= label == own; });
  return same;
}

std::uint64_t shuffled(std::uint64_t at) {
  at = (at ^ at >> 30) * 0xbf58476d1ce4e5b9;
  return at ^ at >> 27;
}

bool touches_air(const LabelView& volume, const glm::ivec3& voxel) {
  bool air = false;
  for (const glm::ivec3& step : kFaceNeighbours) air |= volume.at_or_air(voxel + step) == 0;
  return air;
}

bool can_spare_inside(const LabelView& volume, const glm::ivec3& voxel) {
  const Label own = volume.at(voxel);
  unsigned same = 0, air = 0;
  for_each_around(volume, voxel, [&](int k, Label label) {
    same |= unsigned{label == own} << k;
    air |= label == 0;
  });
  return !air && bits_hang_together(same);
}

}  // namespace limber
