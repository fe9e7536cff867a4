// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/report/whole_bones.h"

#include <algorithm>
#include <map>
#include <utility>

#include <Eigen/LU>
#include <Eigen/SVD>

#include "core/bones/named_bones.h"

namespace limber {

namespace {
// Largest fraction of a bone's voxels that may follow a wrong rig bone, since this many may do so by rounding at its
// border.
constexpr double kAstray = 1e-3;

// Returns for each voxel of the bone graph the bone with the largest weight, as an index into the bones of `weights`.
std::vector<int> followed_bones(const BoneGraph& graph, const TissueVoxels& tissue, const SkinWeights& weights) {
  std::vector<int> bone(graph.size(), 0);
  std::size_t next = 0;
  for (std::int64_t brick = 0; brick < weights.chunk_count(); ++brick) {
    auto influence = weights.chunk(brick).begin();
    tissue.for_each(brick, brick + 1, [&](std::int64_t place, const glm::ivec3&) {
      const Influence& mine = *influence++;
      if (next < graph.place.size() && graph.place[next] == place) bone[next++] = mine.bone[0];
    });
  }
  return bone;
}

double residual_of(const std::vector<std::int32_t>& voxels, const BoneGraph& graph, const AffineTransform& to_world,
                   const std::vector<int>& followed, const std::vector<RigidTransform>& posed_from_rest) {
  // If all voxels follow one rig bone, they move rigidly and the residual is 0.
  const bool is_one =
      std::all_of(voxels.begin(), voxels.end(), [&](std::int32_t i) { return followed[i] == followed[voxels[0]]; });
  if (is_one) return 0;
  std::vector<glm::dvec3> rest, posed;
  for (const std::int32_t i : voxels) {
    rest.push_back(to_world * glm::dvec3(graph.voxel[i]));
    posed.push_back(posed_from_rest[followed[i]] * rest.back());
  }
  const RigidTransform motion = best_rigid_motion(rest, posed);
  double worst = 0;
  for (std::size_t k = 0; k < rest.size(); ++k) worst = std::max(worst, glm::distance(motion * rest[k], posed[k]));
  return worst;
}
}  // namespace

RigidTransform best_rigid_motion(const std::vector<glm::dvec3>& rest, const std::vector<glm::dvec3>& posed) {
  glm::dvec3 rest_centre(0), posed_centre(0);
  for (std::size_t k = 0; k < rest.size(); ++k) rest_centre += rest[k], posed_centre += posed[k];
  if (!rest.empty()) rest_centre /= double(rest.size()), posed_centre /= double(rest.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < rest.size(); ++k) {
    const glm::dvec3 a = rest[k] - rest_centre, b = posed[k] - posed_centre;
    covariance += Eigen::Vector3d(b.x, b.y, b.z) * Eigen::RowVector3d(a.x, a.y, a.z);
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d flip = Eigen::Matrix3d::Identity();
  flip(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  const Eigen::Matrix3d turn = svd.matrixU() * flip * svd.matrixV().transpose();
  glm::dmat3 rotation;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) rotation[column][row] = turn(row, column);
  RigidTransform motion;
  motion.rotation = glm::normalize(glm::quat_cast(rotation));
  motion.translation = posed_centre - motion.rotation * rest_centre;
  return motion;
}

std::vector<WholeBone> whole_bones(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
                                   const Armature& armature, const SkinWeights& weights,
                                   const std::vector<RigidTransform>& posed_from_rest, const BoneMap& map) {
  const std::vector<TissueKind> kinds = tissues.kinds();
  const std::map<Label, LabelBones> labels = bones_of_labels(tissues, armature, map);
  if (labels.empty()) return {};
  const BoneGraph graph = gather_bone(volume, tissue, kinds);
  const NamedBones named = assign_named_bones(graph, volume, kinds, armature, labels);
  const std::vector<int> followed = followed_bones(graph, tissue, weights);
  std::vector<int> in_rig;  // index in the rig of each bone of the weights; -1: the rig lacks the bone
  for (const std::string& name : weights.bones()) {
    const auto found =
        std::find_if(armature.bones.begin(), armature.bones.end(), [&](const Bone& bone) { return bone.name == name; });
    in_rig.push_back(found == armature.bones.end() ? -1 : static_cast<int>(found - armature.bones.begin()));
  }

  std::map<std::pair<Label, std::int32_t>, std::vector<std::int32_t>> members;
  for (std::int32_t i = 0; i < graph.size(); ++i)
    if (const Label label = volume.at(graph.voxel[i]); labels.contains(label))
      members[{label, named.group[i]}].push_back(i);

  const AffineTransform to_world = world_from_voxel(volume.grid);
  std::vector<WholeBone> all;
  for (const auto& [key, voxels] : members) {
    const auto& [label, group] = key;
    const std::vector<int>& allowed = named.candidates[group];
    std::map<int, std::int64_t> right, wrong;
    for (const std::int32_t i : voxels) {
      const int bone = in_rig[followed[i]];
      ++(std::find(allowed.begin(), allowed.end(), bone) != allowed.end() ? right : wrong)[bone];
    }
    const auto most = [](const std::map<int, std::int64_t>& counts) {
      return std::max_element(counts.begin(), counts.end(),
                              [](const auto& a, const auto& b) { return a.second < b.second; })
          ->first;
    };
    WholeBone& bone = all.emplace_back();
    bone.label = label;
    bone.file_value = tissues.find(label)->file_value;
    bone.name = tissues.find(label)->name;
    bone.belongs_to = armature.bones[right.empty() ? allowed.front() : most(right)].name;
    bone.voxels = std::ssize(voxels);
    for (const auto& [_, count] : wrong) bone.wrong_voxels += count;
    if (!wrong.empty())
      bone.went_with = most(wrong) < 0 ? "a bone that the rig lacks" : armature.bones[most(wrong)].name;
    if (labels.at(label).single) bone.residual_mm = residual_of(voxels, graph, to_world, followed, posed_from_rest);
  }
  return all;
}

std::vector<std::string> astray_bones(const std::vector<WholeBone>& bones, std::size_t most) {
  std::vector<const WholeBone*> astray;
  for (const WholeBone& bone : bones)
    if (double(bone.wrong_voxels) > kAstray * double(bone.voxels)) astray.push_back(&bone);
  std::stable_sort(astray.begin(), astray.end(),
                   [](const WholeBone* a, const WholeBone* b) { return a->wrong_voxels > b->wrong_voxels; });
  std::vector<std::string> lines;
  for (std::size_t k = 0; k < std::min(most, astray.size()); ++k)
    lines.push_back(std::to_string(astray[k]->wrong_voxels) + " of " + std::to_string(astray[k]->voxels) +
                    " voxels of \"" + astray[k]->name.substr(0, 80) + "\" follow " + astray[k]->went_with +
                    ", but belong to " + astray[k]->belongs_to +
                    ": compute the weights again, or name the bone with --bone-map");
  if (astray.size() > most)
    lines.push_back(std::to_string(astray.size() - most) +
                    " more bones follow a wrong rig bone; the report lists them");
  return lines;
}

}  // namespace limber
