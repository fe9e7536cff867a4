// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/corner_poser.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/platform/host.h"

namespace limber {

namespace {

std::vector<AffineTransform> shifts_in_voxels(const Grid& grid, const std::vector<RigidTransform>& posed_from_rest) {
  const AffineTransform world = world_from_voxel(grid), voxel = voxel_from_world(grid);
  std::vector<AffineTransform> shifts;
  for (const RigidTransform& posed : posed_from_rest) {
    const glm::dmat3 turn = voxel.linear * (glm::mat3_cast(posed.rotation) - glm::dmat3(1));
    shifts.push_back({turn * world.linear, turn * world.offset + voxel.linear * posed.translation});
  }
  return shifts;
}

BlendRule::Four four_points_of(Blend blend) {
  return has_avx2() ? rule_of(blend).four_points_wide : rule_of(blend).four_points;
}

FourPoints product(const glm::dmat3& m, const FourPoints& p) {
  return {m[0][0] * p.x + m[1][0] * p.y + m[2][0] * p.z, m[0][1] * p.x + m[1][1] * p.y + m[2][1] * p.z,
          m[0][2] * p.x + m[1][2] * p.y + m[2][2] * p.z};
}

FourPoints product(const AffineTransform& m, const FourPoints& p) {
  const FourPoints turned = product(m.linear, p);
  return {turned.x + m.offset.x, turned.y + m.offset.y, turned.z + m.offset.z};
}

bool all_within(const FourNumbers& numbers, double limit) {
  const auto below = (numbers < limit) & (-numbers < limit);
  return below[0] & below[1] & below[2] & below[3];
}

// Rounds to the nearest whole number, as std::lrint does. Doubles near kLarge have no fractional bits, so adding kLarge
// rounds.
FourIntegers rounded(const FourNumbers& numbers) {
  constexpr double kLarge = 6755399441055744.0;  // 1.5 * 2^52: doubles of this size have no fractional bits
  return __builtin_convertvector((numbers + kLarge) - kLarge, FourIntegers);
}

}  // namespace

CornerPoser::CornerPoser(const Grid& grid, const std::vector<std::string>& names,
                         const std::vector<RigidTransform>& posed_from_rest, Blend blend)
    : names_(&names),
      world_from_voxel_(world_from_voxel(grid)),
      voxel_from_world_(voxel_from_world(grid).linear),
      bones_(skin_transforms(posed_from_rest)),
      shift_(shifts_in_voxels(grid, posed_from_rest)),
      blend_(blend),
      four_points_(four_points_of(blend)) {}

FixedPoint CornerPoser::posed(const glm::ivec3& corner, std::span<const BoneWeight> influences,
                              const glm::dvec3& shift) const {
  const glm::dvec3 rest = glm::dvec3(corner) - 0.5;
  const int bone = influences.front().bone;
  if (influences.size() == 1) return fixed(rest, shift_[bone] * rest + shift, bone);
  if (blend_ == Blend::Linear) {
    glm::dvec3 moved(0);
    double total = 0;
    for (const BoneWeight& influence : influences) {
      moved += influence.weight * (shift_[influence.bone] * rest);
      total += influence.weight;
    }
    return fixed(rest, moved / total + shift, bone);
  }
  const glm::dvec3 world = world_from_voxel_ * rest;
  return fixed(rest, voxel_from_world_ * (blend_point(blend_, bones_, influences, world) - world) + shift, bone);
}

FixedPoint CornerPoser::posed_by(int bone, const glm::ivec3& corner, const glm::dvec3& shift) const {
  const glm::dvec3 rest = glm::dvec3(corner) - 0.5;
  return fixed(rest, shift_[bone] * rest + shift, bone);
}

// Computes each lane in the same order of operations as posed() for a single corner, so that the results are equal.
CornerPoser::FourFixed CornerPoser::posed(const FourPoints& rest, const CornerWeights::Four& weights,
                                          const FourPoints* shift) const {
  const auto single = weights.bones == 1;
  FourPoints moved = weights.influences.size() == 1 ? product(shift_[weights.influences[0].bone], rest)
                                                    : this->moved(rest, weights.influences);
  if (weights.influences.size() > 1 && (single[0] | single[1] | single[2] | single[3]))
    replace_single(rest, weights, moved);
  if (shift) moved = moved + *shift;
  const FourPoints to = rest + moved;
  const glm::dvec3 &ratio = output_.ratio, base(output_.base);
  const FourPoints at{(to.x + 0.5) * ratio.x - 0.5 - base.x, (to.y + 0.5) * ratio.y - 0.5 - base.y,
                      (to.z + 0.5) * ratio.z - 0.5 - base.z};
  if (!all_within(at.x, kFurthestPosed) || !all_within(at.y, kFurthestPosed) || !all_within(at.z, kFurthestPosed))
    throw_torn(at, weights.influences);
  return {rounded(at.x * kFixedOne), rounded(at.y * kFixedOne), rounded(at.z * kFixedOne)};
}

FourPoints CornerPoser::moved(const FourPoints& rest, std::span<const FourWeights> influences) const {
  if (blend_ != Blend::Linear) {
    const FourPoints world = product(world_from_voxel_, rest);
    FourPoints at = world;
    four_points_(bones_, influences, at);
    return product(voxel_from_world_, at - world);
  }
  FourPoints moved{};
  FourNumbers total{};
  for (const auto& [bone, weight] : influences) {
    moved = moved + weight * product(shift_[bone], rest);
    total += weight;
  }
  return moved / total;
}

// For corners that follow one bone, replaces the blended displacement by that bone's displacement.
void CornerPoser::replace_single(const FourPoints& rest, const CornerWeights::Four& weights, FourPoints& moved) const {
  for (const auto& [bone, weight] : weights.influences) {
    const auto follows = (weight > 0.0) & __builtin_convertvector(weights.bones == 1, decltype(weight > 0.0));
    if (!(follows[0] | follows[1] | follows[2] | follows[3])) continue;
    moved = select(follows, product(shift_[bone], rest), moved);
  }
}

// Throws the Error "the pose moves the tissue too far away" for the first of four corners that is too far away.
void CornerPoser::throw_torn(const FourPoints& at, std::span<const FourWeights> influences) const {
  for (int i = 0; i < 4; ++i) {
    const double furthest = std::max({std::abs(at.x[i]), std::abs(at.y[i]), std::abs(at.z[i])});
    if (furthest < kFurthestPosed) continue;
    for (const auto& [bone, weight] : influences)
      if (weight[i] > 0) throw_torn(bone);
  }
  throw_torn(influences.front().bone);
}

// Throws an Error that names a bone whose tissue is moved too far away.
void CornerPoser::throw_torn(int bone) const {
  throw Error("the pose moves the tissue too far away", "bone " + (*names_)[bone],
              "check the pose and the rig, or use a coarser spacing");
}

// Returns a posed point in fixed point.
//   moved  posed - rest, in voxel coordinates
//   bone   the bone that the error's message names
FixedPoint CornerPoser::fixed(const glm::dvec3& rest, const glm::dvec3& moved, int bone) const {
  const glm::dvec3 at = output_.from_rest(rest + moved);
  if (!(std::abs(at.x) < kFurthestPosed && std::abs(at.y) < kFurthestPosed && std::abs(at.z) < kFurthestPosed))
    throw_torn(bone);
  // std::lrint is one instruction; std::floor would be a function call.
  return {std::lrint(at.x * kFixedOne), std::lrint(at.y * kFixedOne), std::lrint(at.z * kFixedOne)};
}

}  // namespace limber
