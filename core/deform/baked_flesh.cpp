// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/baked_flesh.h"

#include <algorithm>
#include <climits>
#include <cmath>

#include "core/base/error.h"
#include "core/base/parallel.h"

namespace limber {

namespace {

constexpr int kCorners = TissueVoxels::kBrick + 1;  // corners along a brick's edge

glm::ivec3 floor_divided(const glm::ivec3& a, const glm::ivec3& b) {
  return glm::ivec3(glm::floor(glm::dvec3(a) / glm::dvec3(b)));
}

// Throws Error if the lattice of a joint reaches beyond the volume by more than one lattice cell.
void check_inside(const BakedJoint& joint, const Grid& grid) {
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t low = std::int64_t{joint.first[axis]} * joint.step[axis];
    const std::int64_t high = (std::int64_t{joint.first[axis]} + joint.size[axis] - 1) * joint.step[axis];
    if (low < -joint.step[axis] || high > std::int64_t{grid.size[axis]} + joint.step[axis])
      throw Error("the joint was baked from another volume", joint.bone, "bake the joint again: limber bake-joint");
  }
}

}  // namespace

BakedSampler::BakedSampler(const BakedJoint& joint, const Grid& grid) : joint_(&joint) {
  check_inside(joint, grid);
  index_.assign(std::size_t(joint.size.x) * joint.size.y * joint.size.z, -1);
  for (std::size_t n = 0; n < joint.nodes.size(); ++n) index_[joint.nodes[n]] = static_cast<std::int32_t>(n);
}

BakedSampler::Shares BakedSampler::at(const glm::dvec3& place) const {
  const glm::ivec3& size = joint_->size;
  const glm::dvec3 node = place / glm::dvec3(joint_->step) - glm::dvec3(joint_->first);
  const glm::ivec3 low(glm::floor(node));
  Shares shares;
  if (glm::any(glm::lessThan(low, glm::ivec3(-1))) || glm::any(glm::greaterThanEqual(low, size))) return shares;
  const glm::vec3 high = glm::vec3(node - glm::dvec3(low)), rest = 1.0f - high;
  for (int i = 0; i < 8; ++i) {
    const glm::ivec3 n = low + glm::ivec3(i & 1, i >> 1 & 1, i >> 2);
    const float share = (i & 1 ? high.x : rest.x) * (i & 2 ? high.y : rest.y) * (i & 4 ? high.z : rest.z);
    if (share == 0 || glm::any(glm::lessThan(n, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(n, size))) continue;
    const std::int32_t index = index_[n.x + std::size_t(size.x) * (n.y + std::size_t(size.y) * n.z)];
    if (index < 0) continue;
    shares.node[shares.count] = index;
    shares.share[shares.count++] = share;
  }
  return shares;
}

BakedSampler::Shares BakedSampler::nearest(const glm::ivec3& place, int reach) const {
  const BakedJoint& joint = *joint_;
  const glm::ivec3 low = glm::max(-floor_divided(reach - place, joint.step) - joint.first, glm::ivec3(0));
  const glm::ivec3 high = glm::min(floor_divided(place + reach, joint.step) - joint.first, joint.size - 1);
  Shares nearest;
  int least = INT_MAX;
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x) {
        const std::int32_t node = index_[x + std::size_t(joint.size.x) * (y + std::size_t(joint.size.y) * z)];
        if (node < 0) continue;
        const glm::ivec3 away = (joint.first + glm::ivec3(x, y, z)) * joint.step - place;
        const int squared = away.x * away.x + away.y * away.y + away.z * away.z;
        if (squared >= least) continue;
        least = squared;
        nearest.count = 1;
        nearest.node[0] = node;
        nearest.share[0] = 1;
      }
  return nearest;
}

BakedFlesh::BakedFlesh(const TissueVoxels& tissue, const Grid& grid, const std::vector<BentJoint>& joints)
    : tissue_(&tissue) {
  const glm::dmat3 to_voxels = voxel_from_world(grid).linear;
  for (const BentJoint& bent : joints) {
    const BakedJoint& joint = *bent.baked;
    check_inside(joint, grid);
    const auto shares = shares_at(joint.degrees, bent.degrees);
    if (shares.empty() || joint.nodes.empty()) continue;
    const glm::mat3 turn(to_voxels * glm::mat3_cast(bent.parent_turn));
    Field& field = fields_.emplace_back(Field{joint.step, joint.first, joint.size, {}});
    field.shift.assign(std::size_t(joint.size.x) * joint.size.y * joint.size.z, glm::vec3(0));
    parallel_for(std::ssize(joint.nodes), 4096, [&](std::int64_t begin, std::int64_t end) {
      for (auto n = begin; n < end; ++n) {
        glm::vec3 sum(0);
        for (const auto& [angle, share] : shares) sum += static_cast<float>(share) * joint.shifts[angle][n];
        field.shift[joint.nodes[n]] = turn * sum;
      }
    });
  }
  const std::int64_t count = std::ssize(tissue.bricks());
  bends_.assign(count, 0);
  parallel_for(count, 64, [&](std::int64_t begin, std::int64_t end) {
    for (auto brick = begin; brick < end; ++brick) {
      const glm::ivec3 low = tissue.bricks()[brick].corner;
      for (const Field& field : fields_) bends_[brick] |= field.touches(low, low + TissueVoxels::kBrick);
    }
  });
}

// Returns whether any lattice node around the voxel corners in the box from `low` to `high` has a shift.
bool BakedFlesh::Field::touches(const glm::ivec3& low, const glm::ivec3& high) const {
  const glm::ivec3 from = glm::max(floor_divided(low, step) - first, glm::ivec3(0));
  const glm::ivec3 to = glm::min(-floor_divided(-high, step) - first, size - 1);
  for (int z = from.z; z <= to.z; ++z)
    for (int y = from.y; y <= to.y; ++y)
      for (int x = from.x; x <= to.x; ++x)
        if (shift[x + std::size_t(size.x) * (y + std::size_t(size.y) * z)] != glm::vec3(0)) return true;
  return false;
}

BakedFlesh::Field::Along BakedFlesh::Field::along(int axis, double place) const {
  const double node = place / step[axis] - first[axis], low = std::floor(node);
  // For a place outside the box, uses the nearest position just outside the box, where shifts are zero.
  return {static_cast<int>(std::clamp(low, -2.0, double(size[axis]))), static_cast<float>(node - low)};
}

// Returns the shift at a place between eight nodes. Nodes outside the box have the shift zero.
glm::vec3 BakedFlesh::Field::between(const Along& x, const Along& y, const Along& z) const {
  glm::vec3 sum(0);
  for (int k = 0; k < 2; ++k) {
    const float share_z = k ? z.share : 1 - z.share;
    if (share_z == 0 || z.low + k < 0 || z.low + k >= size.z) continue;
    for (int j = 0; j < 2; ++j) {
      const float share_yz = (j ? y.share : 1 - y.share) * share_z;
      if (share_yz == 0 || y.low + j < 0 || y.low + j >= size.y) continue;
      const glm::vec3* row = shift.data() + std::size_t(size.x) * (y.low + j + std::size_t(size.y) * (z.low + k));
      for (int i = 0; i < 2; ++i) {
        const float share = (i ? x.share : 1 - x.share) * share_yz;
        if (share != 0 && x.low + i >= 0 && x.low + i < size.x) sum += share * row[x.low + i];
      }
    }
  }
  return sum;
}

glm::vec3 BakedFlesh::Field::at(const glm::dvec3& place) const {
  return between(along(0, place.x), along(1, place.y), along(2, place.z));
}

void BakedFlesh::Field::add(const glm::ivec3& low, CornerShifts& shifts) const {
  std::array<std::array<Along, kCorners>, 3> places;
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < kCorners; ++i) places[axis][i] = along(axis, low[axis] + i);
  std::size_t to = 0;
  for (const Along& z : places[2])
    for (const Along& y : places[1])
      for (const Along& x : places[0]) shifts[to++] += between(x, y, z);
}

bool BakedFlesh::corner_shifts(std::int64_t brick, CornerShifts& shifts) const {
  if (!bends_[brick]) return false;
  shifts.fill(glm::vec3(0));
  const glm::ivec3 low = tissue_->bricks()[brick].corner;
  for (const Field& field : fields_)
    if (field.touches(low, low + TissueVoxels::kBrick)) field.add(low, shifts);
  return true;
}

glm::vec3 BakedFlesh::corner_shift(const glm::ivec3& lowest, unsigned) const {
  return shift_at(glm::dvec3(lowest + 1));
}

glm::vec3 BakedFlesh::shift_at(const glm::dvec3& place) const {
  glm::vec3 sum(0);
  for (const Field& field : fields_) sum += field.at(place);
  return sum;
}

}  // namespace limber
