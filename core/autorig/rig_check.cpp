// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/autorig/rig_check.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

namespace limber {

namespace {
constexpr double kStep = 0.5;  // step between examined points along a bone, as a share of the smallest voxel spacing
constexpr double kMostSteps = 10'000;
}  // namespace

RigCheck check_rig(const LabelVolume& volume, const Armature& armature) {
  RigCheck check;
  const AffineTransform to_voxel = voxel_from_world(volume.grid);
  const double spacing = std::min({volume.grid.spacing.x, volume.grid.spacing.y, volume.grid.spacing.z});
  const auto in_tissue = [&](const glm::dvec3& place) {
    const glm::dvec3 v = glm::floor(to_voxel * place + 0.5);
    const bool inside =
        glm::all(glm::greaterThanEqual(v, glm::dvec3(0))) && glm::all(glm::lessThan(v, glm::dvec3(volume.grid.size)));
    return inside && volume.at(glm::ivec3(v)) != 0;
  };
  double length = 0, within = 0;
  for (int b = 0; b < std::ssize(armature.bones); ++b) {
    const Bone& bone = armature.bones[b];
    const double own = glm::distance(bone.head, bone.tail);
    const int steps = static_cast<int>(std::clamp(own / (kStep * spacing), 4.0, kMostSteps));
    int inside = 0, run = -1;
    for (int k = 0; k <= steps; ++k) {
      const bool is_in = k < steps && in_tissue(glm::mix(bone.head, bone.tail, (k + 0.5) / steps));
      inside += is_in;
      if (k < steps && !is_in && run < 0) run = k;
      if (run >= 0 && (is_in || k == steps)) {
        const double from = double(run) / steps, to = double(k) / steps;
        check.leaving.push_back({b, from, to, glm::mix(bone.head, bone.tail, (from + to) / 2)});
        run = -1;
      }
    }
    check.share.push_back(double(inside) / steps);
    length += own;
    within += own * check.share.back();
  }
  check.whole = length > 0 ? within / length : 0;
  std::set<std::tuple<double, double, double>> seen;
  for (const bool tail : {true, false})
    for (int b = 0; b < std::ssize(armature.bones); ++b) {
      const glm::dvec3& place = tail ? armature.bones[b].tail : armature.bones[b].head;
      if (seen.insert({place.x, place.y, place.z}).second && !in_tissue(place))
        check.outside.push_back({b, tail, place});
    }
  std::stable_sort(check.outside.begin(), check.outside.end(),
                   [](const auto& a, const auto& b) { return a.bone < b.bone; });
  return check;
}

}  // namespace limber
