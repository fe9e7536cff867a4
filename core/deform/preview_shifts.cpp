// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/preview_shifts.h"

#include <algorithm>

#include "core/base/parallel.h"

namespace limber {

// Computes the shifts of a joint at the lattice's vertices. The joint may have nodes only in tissue. So vertices in the
// air around the skin get the shift of the nearest node.
PreviewShifts::Table PreviewShifts::sampled(const PreviewLattice& lattice, const BakedJoint& joint) {
  const BakedSampler sampler(joint, lattice.grid);
  std::vector<std::uint8_t> is_vertex(lattice.places(), 0);
  for (const glm::ivec3& cell : lattice.cells)
    for (int i = 0; i < 8; ++i) is_vertex[lattice.place(cell + glm::ivec3(i & 1, i >> 1 & 1, i >> 2))] = 1;
  std::vector<std::int32_t> places;
  std::vector<BakedSampler::Shares> shares;
  glm::ivec3 v;
  for (v.z = 0; v.z <= lattice.size.z; ++v.z)
    for (v.y = 0; v.y <= lattice.size.y; ++v.y)
      for (v.x = 0; v.x <= lattice.size.x; ++v.x) {
        const glm::ivec3 vertex = lattice.first + v;
        const std::int64_t place = lattice.place(vertex);
        if (!is_vertex[place]) continue;
        BakedSampler::Shares around = sampler.at(glm::dvec3(vertex * lattice.step));
        if (around.count == 0) around = sampler.nearest(vertex * lattice.step, 2 * lattice.step);
        if (around.count == 0) continue;
        places.push_back(static_cast<std::int32_t>(place));
        shares.push_back(around);
      }
  Table table{std::move(places), std::vector<std::vector<glm::vec3>>(joint.degrees.size())};
  for (std::size_t a = 0; a < joint.degrees.size(); ++a)
    if (joint.degrees[a] != 0)
      for (const BakedSampler::Shares& around : shares) {
        glm::vec3 sum(0);
        for (int i = 0; i < around.count; ++i) sum += around.share[i] * joint.shifts[a][around.node[i]];
        table.by_angle[a].push_back(sum);
      }
  return table;
}

bool PreviewShifts::set(const PreviewLattice& lattice, const std::vector<BentJoint>& joints) {
  if (joints == joints_) return false;
  const auto same_joints = [](const BentJoint& a, const BentJoint& b) { return a.baked == b.baked; };
  shift_.resize(lattice.places());
  is_near_.resize(lattice.places());
  const bool same = std::equal(joints.begin(), joints.end(), joints_.begin(), joints_.end(), same_joints);
  if (same) {
    for (const Table& table : tables_)
      for (const std::int32_t place : table.places) shift_[place] = glm::vec3(0);
  } else {
    std::fill(shift_.begin(), shift_.end(), glm::vec3(0));
    std::fill(is_near_.begin(), is_near_.end(), 0);
    // A vertex near a joint of the previous pose that is not among the new joints has a changed shift too.
    for (const Table& table : tables_)
      for (const std::int32_t place : table.places) is_near_[place] = 1;
    tables_.clear();
    for (const BentJoint& joint : joints) tables_.push_back(sampled(lattice, *joint.baked));
    for (const Table& table : tables_)
      for (const std::int32_t place : table.places) is_near_[place] = 1;
  }
  joints_ = joints;
  const glm::dmat3 to_cells = voxel_from_world(lattice.grid).linear / double(lattice.step);
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const Table& table = tables_[j];
    const auto shares = shares_at(joints[j].baked->degrees, joints[j].degrees);
    const glm::mat3 turn(to_cells * glm::mat3_cast(joints[j].parent_turn));
    parallel_for(std::ssize(table.places), 1024, [&](std::int64_t begin, std::int64_t end) {
      for (auto i = begin; i < end; ++i) {
        glm::vec3 sum(0);
        for (const auto& [angle, share] : shares) sum += static_cast<float>(share) * table.by_angle[angle][i];
        shift_[table.places[i]] += turn * sum;
      }
    });
  }
  return true;
}

}  // namespace limber
