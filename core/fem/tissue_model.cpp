// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/tissue_model.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include <Eigen/LU>

#include "core/base/disjoint_sets.h"
#include "core/deform/box_bins.h"
#include "core/mesh/lattice_net.h"

namespace limber {

namespace {

constexpr int kReach = 16;  // radius within which the tissue nearest to a position is searched, voxels
constexpr int kPlaces = 4;  // intervals along each tet edge between the points where labels are read
// A tet's share of tissue, TetMaterial::filled, is raised to at least this, so that every tet resists a change of its
// volume.
constexpr double kLeastFilled = 0.1;
// Larger Poisson ratios are cut to this; with 0.5 the volume terms would be infinite.
constexpr double kMostPoisson = 0.4999;

TetMaterial material_of(const Tissue& tissue, double stiffest) {
  const double nu = std::clamp(tissue.poisson_ratio, 0.0, kMostPoisson);
  return {std::clamp(tissue.young_modulus / (2 * (1 + nu)), 1e-3, stiffest), nu};
}

// Finds the tissue voxel nearest to a position in the world.
class Surroundings {
 public:
  explicit Surroundings(const LabelVolume& volume) : volume_(volume), voxel_(voxel_from_world(volume.grid)) {}

  // Sets `found` to the tissue voxel nearest to a position, in mm, for which passes() is true. Returns false if there
  // is none within kReach voxels.
  template <class Passes>
  bool nearest(const Eigen::RowVector3d& world, const Passes& passes, glm::ivec3& found) const {
    const glm::dvec3 at = voxel_ * glm::dvec3(world[0], world[1], world[2]), spacing = volume_.grid.spacing;
    const glm::ivec3 middle(glm::floor(at + 0.5));
    const double least_spacing = std::min({spacing.x, spacing.y, spacing.z});
    double least = INFINITY;
    for (int reach = 0; reach <= kReach && least > std::pow(std::max(reach - 1, 0) * least_spacing, 2); ++reach)
      for_each_in_shell(reach, [&](const glm::ivec3& step) {
        const glm::ivec3 v = middle + step;
        const glm::dvec3 off = (glm::dvec3(v) - at) * spacing;
        const double squared = glm::dot(off, off);
        if (squared >= least || !volume_.grid.contains(v) || volume_.at(v) == 0 || !passes(v)) return;
        least = squared;
        found = v;
      });
    return least < INFINITY;
  }

 private:
  template <class Body>
  static void for_each_in_shell(int reach, const Body& body) {
    for (int z = -reach; z <= reach; ++z)
      for (int y = -reach; y <= reach; ++y) {
        const bool whole = std::abs(z) == reach || std::abs(y) == reach;
        for (int x = -reach; x <= reach; x += whole || reach == 0 ? 1 : 2 * reach) body(glm::ivec3(x, y, z));
      }
  }

  const LabelVolume& volume_;
  AffineTransform voxel_;
};

bool is_in(const TissueMask& mask, const TissueVoxels& tissue, const glm::ivec3& v) {
  const int brick = tissue.brick_at(v);
  return brick >= 0 && (mask[brick][v.z & 7] >> ((v.x & 7) + 8 * (v.y & 7)) & 1);
}

Influence influence_at(const SkinWeights& weights, const TissueVoxels& tissue, const glm::ivec3& v) {
  const int brick = tissue.brick_at(v);
  return weights.chunk(brick)[tissue.index_of(v) - tissue.bricks()[brick].first];
}

// Returns the mean influences of the tissue voxels among the 27 voxels around a tissue voxel.
std::vector<BoneWeight> influences_around(const SkinWeights& weights, const LabelVolume& volume,
                                          const TissueVoxels& tissue, const std::vector<int>& moves_as,
                                          const glm::ivec3& voxel) {
  std::vector<std::pair<int, std::int64_t>> sums;  // (bone, sum of its weights), by ascending bone
  std::int64_t total = 0;
  const auto add = [&](int bone, int weight) {
    const auto at = std::lower_bound(sums.begin(), sums.end(), bone,
                                     [](const auto& sum, int wanted) { return sum.first < wanted; });
    if (at != sums.end() && at->first == bone) at->second += weight;
    else sums.insert(at, {bone, weight});
  };
  for (int i = 0; i < 27; ++i) {
    const glm::ivec3 v = voxel + glm::ivec3(i % 3, i / 3 % 3, i / 9) - 1;
    if (volume.at_or_air(v) == 0) continue;
    const Influence influence = influence_at(weights, tissue, v);
    for (int k = 0; k < 4 && influence.weight[k]; ++k) add(moves_as[influence.bone[k]], influence.weight[k]);
    total += kFullWeight;
  }
  std::vector<BoneWeight> result;
  for (const auto& [bone, sum] : sums) result.push_back({bone, double(sum) / double(total)});
  return result;
}

// Estimates the volume that each label fills in each tet: reads the labels at 35 points of the tet, each of which
// represents the same share of the tet's volume.
void find_parts(TissueModel& model, const LabelVolume& volume) {
  const TetMesh& mesh = model.fem.mesh;
  const AffineTransform voxel = voxel_from_world(volume.grid);
  std::vector<glm::dvec3> node;
  for (int i = 0; i < mesh.V.rows(); ++i) node.push_back(voxel * glm::dvec3(mesh.V(i, 0), mesh.V(i, 1), mesh.V(i, 2)));
  std::vector<glm::dvec4> shares;  // barycentric coordinates of the sample points
  for (int i = 0; i <= kPlaces; ++i)
    for (int j = 0; i + j <= kPlaces; ++j)
      for (int k = 0; i + j + k <= kPlaces; ++k)
        shares.push_back((glm::dvec4(i, j, k, kPlaces - i - j - k) + 0.25) / (kPlaces + 1.0));
  std::vector<Label> found(shares.size());
  for (int t = 0; t < mesh.T.rows(); ++t) {
    model.first.push_back(static_cast<std::int32_t>(model.parts.size()));
    glm::dmat4x3 corners;
    for (int c = 0; c < 4; ++c) corners[c] = node[mesh.T(t, c)];
    std::transform(shares.begin(), shares.end(), found.begin(), [&](const glm::dvec4& share) {
      return volume.at_or_air(glm::ivec3(glm::floor(corners * share + 0.5)));
    });
    if (std::adjacent_find(found.begin(), found.end(), std::not_equal_to()) != found.end())
      std::sort(found.begin(), found.end());
    const double each = signed_volume(mesh.V, mesh.T.row(t)) / double(found.size());
    for (auto first = found.begin(); first != found.end();) {
      const auto end = std::upper_bound(first, found.end(), *first);
      if (*first != 0) model.parts.push_back({*first, each * double(end - first)});
      first = end;
    }
  }
  model.first.push_back(static_cast<std::int32_t>(model.parts.size()));
}

void choose_materials(TissueModel& model, const LabelVolume& volume, const TissueTable& tissues,
                      const TissueModelSettings& settings) {
  std::vector<TetMaterial> of_label(65536);
  LabelSet is_soft(65536, 1);
  for (const Tissue& each : tissues.tissues) {
    of_label[each.label] = material_of(each, settings.stiffest);
    is_soft[each.label] = !is_bone(each.kind);
  }
  const Surroundings around(volume);
  const TetMesh& mesh = model.fem.mesh;
  for (int t = 0; t < mesh.T.rows(); ++t) {
    const bool in_bone = mesh.region[t] != TetMesh::kSoft;
    if (model.joint[t] || in_bone) {
      model.fem.material.push_back(model.joint[t] ? settings.joint : settings.bone);
      continue;
    }
    double mu = 0, lambda = 0, soft = 0;
    const auto add = [&](Label label, double mm3) {
      mu += mm3 * of_label[label].shear_modulus;
      lambda += mm3 * lame_lambda(of_label[label].shear_modulus, of_label[label].poisson_ratio);
      soft += mm3;
    };
    const double whole = signed_volume(mesh.V, mesh.T.row(t));
    for (std::int32_t i = model.first[t]; i < model.first[t + 1]; ++i)
      if (const auto& [label, mm3] = model.parts[i]; is_soft[label]) add(label, mm3);
    glm::ivec3 nearest(0);
    if (soft == 0 && around.nearest((mesh.V.row(mesh.T(t, 0)) + mesh.V.row(mesh.T(t, 1)) + mesh.V.row(mesh.T(t, 2)) +
                                     mesh.V.row(mesh.T(t, 3))) /
                                        4,
                                    [&](const glm::ivec3& v) { return is_soft[volume.at(v)] != 0; }, nearest))
      add(volume.at(nearest), kLeastFilled * whole);
    model.fem.material.push_back(
        soft > 0 ? TetMaterial{mu / soft, lambda / (2 * (lambda + mu)), std::max(kLeastFilled, soft / whole)}
                 : settings.joint);
  }
}

// Returns the largest share by which a pose may change the volume of a tissue of this many voxels; 0: any.
double kept_within(const Tissue& tissue, std::int64_t voxels) {
  constexpr std::int64_t kLarge = 5000, kSmall = 500;
  if (is_bone(tissue.kind) || tissue.kind == TissueKind::Cavity || tissue.poisson_ratio < 0.4 || voxels < kSmall)
    return 0;
  return voxels < kLarge ? 0.02 : 0.002;
}

void keep_volumes(TissueModel& model, const LabelVolume& volume, const TissueTable& tissues) {
  std::vector<std::int64_t> voxels(65536, 0);
  for (const Label label : volume.voxels) ++voxels[label];
  std::map<Label, KeptVolume> kept;
  for (const Tissue& each : tissues.tissues)
    if (const double within = kept_within(each, voxels[each.label])) kept[each.label].within = within;
  for (int t = 0; t < model.fem.mesh.T.rows(); ++t)
    for (std::int32_t i = model.first[t]; i < model.first[t + 1] && !model.joint[t]; ++i)
      if (const auto found = kept.find(model.parts[i].label); found != kept.end())
        found->second.parts.push_back({t, model.parts[i].mm3});
  for (auto& [label, each] : kept)
    if (!each.parts.empty()) model.fem.kept.push_back(std::move(each));
}

constexpr int kNone = -1, kSeveral = -2;

// Returns 1 for each node that belongs to a joint: the sum of its distances to the two nearest bones is less than
// `joint_mm`. Of the nodes of a bone itself, at most half are included, those nearest to another bone.
//   bone  #V: the bone of each node; kNone: soft tissue; kSeveral: shared by bones
std::vector<std::uint8_t> nodes_of_joints(const TetMesh& mesh, const std::vector<int>& bone, double joint_mm) {
  const auto place = [&](int i) { return glm::dvec3(mesh.V(i, 0), mesh.V(i, 1), mesh.V(i, 2)); };
  std::vector<int> held;  // the nodes of bones
  std::vector<glm::dvec3> held_at;
  for (int i = 0; i < mesh.V.rows(); ++i)
    if (bone[i] >= 0) held.push_back(i), held_at.push_back(place(i));
  const PointBins bins(held_at, joint_mm);
  std::map<int, std::vector<std::pair<double, int>>> near_other;  // for each bone: (distance to another bone, node)
  std::map<int, std::size_t> count;
  std::vector<std::uint8_t> between(mesh.V.rows(), 0);
  std::vector<int> near;
  for (int i = 0; i < mesh.V.rows(); ++i) {
    if (bone[i] >= 0) ++count[bone[i]];
    bins.near(place(i), near);
    std::map<int, double> to_bone;
    for (int n : near) {
      const double distance = (mesh.V.row(held[n]) - mesh.V.row(i)).norm();
      const auto [at, is_first] = to_bone.try_emplace(bone[held[n]], distance);
      at->second = std::min(at->second, distance);
    }
    if (to_bone.size() < 2) continue;
    std::vector<double> ways;
    for (const auto& [which, distance] : to_bone) ways.push_back(distance);
    std::partial_sort(ways.begin(), ways.begin() + 2, ways.end());
    if (ways[0] + ways[1] >= joint_mm) continue;
    if (bone[i] >= 0) near_other[bone[i]].push_back({ways[1], i});
    else between[i] = 1;
  }
  for (auto& [which, nodes] : near_other) {
    std::sort(nodes.begin(), nodes.end());
    nodes.resize(std::min(nodes.size(), count[which] / 2));
    for (const auto& [distance, node] : nodes) between[node] = 1;
  }
  return between;
}

// Marks the nodes of bones that the pose brings closer to another bone than `closing_mm`, if they are further away at
// rest. At most half of a bone's nodes are marked, those nearest to another bone.
//   marked  #V: 1 for nodes that belong to a joint
void mark_closing_bones(const TetMesh& mesh, const std::vector<int>& bone,
                        const std::vector<std::vector<RigidTransform>>& motions, double closing_mm,
                        std::vector<std::uint8_t>& marked) {
  std::map<int, std::size_t> count, free;  // for each bone: number of its nodes; how many of them may still be marked
  std::vector<int> nodes;
  for (int i = 0; i < mesh.V.rows(); ++i)
    if (bone[i] >= 0) nodes.push_back(i), ++count[bone[i]];
  for (const auto& [which, all] : count) free[which] = all / 2;
  for (const int i : nodes)
    if (marked[i] && free[bone[i]] > 0) --free[bone[i]];

  std::vector<double> nearest(nodes.size(), INFINITY);
  for (const std::vector<RigidTransform>& motion : motions) {
    std::vector<glm::dvec3> posed;
    for (const int i : nodes) posed.push_back(motion[bone[i]] * glm::dvec3(mesh.V(i, 0), mesh.V(i, 1), mesh.V(i, 2)));
    const PointBins bins(posed, closing_mm);
    std::vector<int> near;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      bins.near(posed[k], near);
      for (const int n : near)
        if (bone[nodes[n]] != bone[nodes[k]]) nearest[k] = std::min(nearest[k], glm::distance(posed[n], posed[k]));
    }
  }
  std::vector<std::pair<double, int>> closing;
  for (std::size_t k = 0; k < nodes.size(); ++k)
    if (nearest[k] < closing_mm && !marked[nodes[k]]) closing.push_back({nearest[k], nodes[k]});
  std::sort(closing.begin(), closing.end());
  for (const auto& [distance, node] : closing)
    if (std::size_t& left = free[bone[node]]; left > 0) marked[node] = 1, --left;
}

// Returns for each node the side of the seams on which all tets around the node lie; a negative value if they lie on
// several sides, or if there are no seams.
std::vector<int> sides_of_nodes(const TetMesh& mesh) {
  const std::vector<std::uint16_t>& side = mesh.side;
  std::vector<int> sides(mesh.V.rows(), kSeveral);
  if (side.empty()) return sides;
  std::fill(sides.begin(), sides.end(), kNone);
  for (int t = 0; t < mesh.T.rows(); ++t)
    for (const int node : mesh.T.row(t))
      sides[node] = sides[node] == kNone || sides[node] == side[t] ? side[t] : kSeveral;
  return sides;
}

// Frees the nodes of soft tissue near places where two sides of seams touch in the mesh. The mesh is coarser than the
// body: around the voxels at a seam it may also close gaps of air between tissue that moves rigidly. There the two
// sides would interlock.
//   side     side of seams of each node
//   is_held  is_held(node, mm) returns true if the node must stay held because there is tissue within this distance
//            that is not meshed
template <class IsHeld>
void free_nodes_at_seams(FemModel& fem, const std::vector<int>& side, const IsHeld& is_held) {
  constexpr int kRings = 2;  // number of tets between the two sides and the nodes that stay held
  const TetMesh& mesh = fem.mesh;
  if (mesh.side.empty()) return;
  std::vector<double> edge(mesh.V.rows(), 0);  // length of each node's longest edge
  for (const auto& tet : mesh.T.rowwise())
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < a; ++b) {
        const double length = (mesh.V.row(tet[a]) - mesh.V.row(tet[b])).norm();
        for (const int node : {tet[a], tet[b]}) edge[node] = std::max(edge[node], length);
      }
  std::vector<int> at_border;
  std::vector<VoxelRange> boxes;
  std::vector<char> is_at_border(mesh.V.rows(), 0), is_near(mesh.V.rows(), 0);
  const Eigen::MatrixX3i border = boundary_of(mesh);
  for (const int node : border.reshaped()) is_at_border[node] = 1;
  for (int i = 0; i < mesh.V.rows(); ++i) {
    if (!is_at_border[i] || side[i] < 0) continue;
    const glm::ivec3 cell(glm::floor(glm::dvec3(mesh.V(i, 0), mesh.V(i, 1), mesh.V(i, 2))));
    at_border.push_back(i), boxes.push_back({cell, cell});
  }
  const BoxBins bins(boxes, 16);
  std::vector<int> near;
  for (std::size_t k = 0; k < at_border.size(); ++k) {
    const int node = at_border[k], reach = static_cast<int>(std::ceil(edge[node]));
    bins.meeting({boxes[k].low - reach, boxes[k].high + reach}, near);
    is_near[node] = std::any_of(near.begin(), near.end(), [&](int n) {
      const int other = at_border[n];
      return side[other] != side[node] && (mesh.V.row(other) - mesh.V.row(node)).norm() < edge[node];
    });
  }
  for (int ring = 0; ring < kRings; ++ring) {
    const std::vector<char> inner = is_near;
    for (const auto& tet : mesh.T.rowwise())
      if (std::any_of(tet.begin(), tet.end(), [&](int node) { return inner[node]; }))
        for (const int node : tet) is_near[node] = 1;
  }
  std::vector<char> in_bone(mesh.V.rows(), 0);
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t)
    if (mesh.region[t] != TetMesh::kSoft)
      for (const int node : mesh.T.row(t)) in_bone[node] = 1;
  for (int i = 0; i < mesh.V.rows(); ++i) is_near[i] = is_near[i] && !in_bone[i] && !is_held(i, edge[i]);
  for (int i = 0; i < mesh.V.rows(); ++i)
    if (is_near[i]) fem.held_by[i] = kNone;
  std::erase_if(fem.waiting, [&](const FemModel::Waiting& each) { return is_near[each.node]; });
}

// Holds the parts of the mesh that no bone ever holds, such as flakes that were cut off at seams: nothing would
// determine their position. Each moves rigidly with the bone that most of its nodes follow.
void hold_loose_parts(FemModel& fem) {
  if (fem.mesh.side.empty()) return;
  const int nodes = int(fem.mesh.V.rows());
  DisjointSets parts(nodes);
  for (const auto& tet : fem.mesh.T.rowwise())
    for (int i = 1; i < 4; ++i) parts.unite(tet[0], tet[i]);
  std::vector<char> is_held(nodes, 0);
  for (int i = 0; i < nodes; ++i)
    if (fem.held_by[i] >= 0) is_held[parts.least(i)] = 1;
  for (const FemModel::Waiting& each : fem.waiting) is_held[parts.least(each.node)] = 1;
  std::map<int, std::map<int, double>> follows;  // for each loose part, the sum of its nodes' weights by bone
  for (int i = 0; i < nodes; ++i)
    if (const int of = parts.least(i); !is_held[of])
      for (const auto& [bone, weight] : fem.influences[i]) follows[of][bone] += weight;
  std::map<int, int> holder;
  for (const auto& [of, bones] : follows)
    holder[of] = std::max_element(bones.begin(), bones.end(), [](const auto& a, const auto& b) {
                   return a.second < b.second;
                 })->first;
  for (int i = 0; i < nodes; ++i)
    if (const auto of = holder.find(parts.least(i)); of != holder.end()) {
      fem.held_by[i] = of->second;
      fem.influences[i] = {{of->second, 1.0}};
    }
}

// Selects the bone that holds each node: the bone of the bone tets around the node or, in soft tissue that moves
// rigidly, the bone that this tissue follows. Also marks the tets between two bones as joints. Returns the nodes of
// bone over which soft tissue slides (sliding_nodes.h).
std::vector<std::uint8_t> choose_holders(TissueModel& model, const LabelVolume& volume, const TissueVoxels& tissue,
                                         const TissueTable& tissues, const SkinWeights& weights,
                                         const DeformingRegion& moving, const TissueModelSettings& settings) {
  const TetMesh& mesh = model.fem.mesh;
  std::vector<int> bone(mesh.V.rows(), kNone);
  for (int t = 0; t < mesh.T.rows(); ++t) {
    if (mesh.region[t] == TetMesh::kSoft) continue;
    const int mine = TetMesh::bone_of(mesh.region[t]);
    for (int i = 0; i < 4; ++i) {
      int& holder = bone[mesh.T(t, i)];
      holder = holder == kNone || holder == mine ? mine : kSeveral;
    }
  }
  std::vector<std::uint8_t> in_joint = nodes_of_joints(mesh, bone, settings.joint_mm);
  mark_closing_bones(mesh, bone, settings.motions, settings.closing_mm, in_joint);
  SlidingSettings sliding = settings.sliding;
  sliding.motions = settings.motions, sliding.joint_mm = settings.joint_mm, sliding.closing_mm = settings.closing_mm;
  const std::vector<std::uint8_t> slides = sliding_nodes(volume, tissues, mesh, bone, sliding);
  for (std::size_t i = 0; i < slides.size(); ++i)
    // A node over which tissue slides has no other bone in front, so it belongs to no joint.
    if (slides[i]) in_joint[i] = 0;
  for (int t = 0; t < mesh.T.rows(); ++t) {
    int first = kNone;
    bool between = false, inside = true;
    for (int i = 0; i < 4; ++i) {
      const int holder = bone[mesh.T(t, i)];
      between |= holder == kSeveral || (holder >= 0 && first >= 0 && holder != first);
      between |= mesh.region[t] != TetMesh::kSoft && in_joint[mesh.T(t, i)];
      inside &= in_joint[mesh.T(t, i)] != 0;
      if (holder >= 0) first = holder;
    }
    model.joint.push_back(between || inside);
  }

  const Surroundings around(volume);
  const std::vector<int> side = sides_of_nodes(mesh);
  for (int i = 0; i < mesh.V.rows(); ++i) {
    glm::ivec3 voxel(0);
    // A node at a seam must not follow tissue on the other side of the seam.
    const auto is_near = [&](const glm::ivec3& v) {
      return is_in(moving.meshed, tissue, v) &&
             (side[i] < 0 || settings.sides->of_voxel[tissue.index_of(v)] == side[i]);
    };
    const bool found = around.nearest(mesh.V.row(i), is_near, voxel);
    int holder = bone[i] == kSeveral || in_joint[i] ? kNone : bone[i];
    if (const float from = found && bone[i] == kNone ? moving.free_from_at(tissue, voxel) : 0; from > 0) {
      const int with = moving.moves_as[influence_at(weights, tissue, voxel).bone[0]];
      if (from < INFINITY) model.fem.waiting.push_back({i, with, from});
      else holder = with;
    }
    model.fem.held_by.push_back(holder);
    if (found) model.fem.influences.push_back(influences_around(weights, volume, tissue, moving.moves_as, voxel));
    else model.fem.influences.push_back({{std::max(holder, 0), 1.0}});
    if (holder >= 0) model.fem.influences.back() = {{holder, 1.0}};
  }
  free_nodes_at_seams(model.fem, side, [&](int node, double mm) {
    glm::ivec3 voxel;
    const auto is_beyond = [&](const glm::ivec3& v) { return !is_in(moving.meshed, tissue, v); };
    if (!around.nearest(mesh.V.row(node), is_beyond, voxel)) return false;
    const glm::dvec3 place = world_from_voxel(volume.grid) * glm::dvec3(voxel);
    return (mesh.V.row(node) - Eigen::RowVector3d(place.x, place.y, place.z)).norm() < mm;
  });
  hold_loose_parts(model.fem);
  return slides;
}

}  // namespace

LabelVolume regions_to_mesh(const LabelVolume& volume, const TissueVoxels& tissue, const LabelSet& is_bone,
                            const SkinWeights& weights, const DeformingRegion& moving, const VoxelSides& sides) {
  LabelVolume regions{volume.grid, ZeroedVector<Label>(volume.grid.voxel_count())};
  for (std::int64_t brick = 0; brick < std::ssize(tissue.bricks()); ++brick) {
    auto influence = weights.chunk(brick).begin();
    tissue.for_each(brick, brick + 1, [&](std::int64_t place, const glm::ivec3& v) {
      const int bone = (*influence++).bone[0];
      if (is_in(moving.meshed, tissue, v))
        regions.at(v) = is_bone[volume.at(v)]    ? static_cast<Label>(2 + moving.moves_as[bone])
                        : sides.of_voxel.empty() ? Label{1}
                                                 : static_cast<Label>(1 + soft_region(sides.of_voxel[place]));
    });
  }
  return regions;
}

TissueModel tissue_model(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
                         const SkinWeights& weights, const DeformingRegion& moving, TetMesh mesh,
                         const TissueModelSettings& settings) {
  TissueModel model;
  model.fem.mesh = std::move(mesh);
  model.fem.bone_names = weights.bones();
  let_slide(model.fem, choose_holders(model, volume, tissue, tissues, weights, moving, settings),
            settings.sliding.tet_mm);
  find_parts(model, volume);
  choose_materials(model, volume, tissues, settings);
  keep_volumes(model, volume, tissues);
  return model;
}

std::vector<double> volume_ratios(const TetMesh& mesh, const Eigen::MatrixX3d& V) {
  const auto volume = [&](const Eigen::MatrixX3d& P, int t) {
    Eigen::Matrix3d edges;
    for (int i = 0; i < 3; ++i) edges.col(i) = (P.row(mesh.T(t, i + 1)) - P.row(mesh.T(t, 0))).transpose();
    return edges.determinant();
  };
  std::vector<double> ratios;
  for (int t = 0; t < mesh.T.rows(); ++t) ratios.push_back(volume(V, t) / volume(mesh.V, t));
  return ratios;
}

std::map<Label, double> volume_change_percent(const TissueModel& model, const Eigen::MatrixX3d& V) {
  const std::vector<double> ratios = volume_ratios(model.fem.mesh, V);
  std::map<Label, std::pair<double, double>> before_after;
  for (size_t t = 0; t < ratios.size(); ++t) {
    if (model.joint[t]) continue;
    for (std::int32_t i = model.first[t]; i < model.first[t + 1]; ++i) {
      auto& [before, after] = before_after[model.parts[i].label];
      before += model.parts[i].mm3;
      after += model.parts[i].mm3 * ratios[t];
    }
  }
  std::map<Label, double> change;
  for (const auto& [label, sums] : before_after) change[label] = 100 * (sums.second / sums.first - 1);
  return change;
}

}  // namespace limber
