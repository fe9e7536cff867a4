// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bones/bone_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <queue>
#include <tuple>
#include <utility>

#include "core/bones/bone_watershed.h"
#include "core/bones/gather_parts.h"
#include "core/bones/hugging.h"
#include "core/bones/lonely_piece.h"
#include "core/bones/named_bones.h"
#include "core/bones/shoulder_girdles.h"

namespace limber {

namespace {

// Rounding to voxels makes the depth along the middle of a smooth, thick bone vary by up to this many voxels.
constexpr double kWiggleVoxels = 0.6;
// If there are more pairs of a basin and a rig bone than this, small basins are merged first: a distance is stored for
// each pair, and at this limit all distances take 64 MB.
constexpr std::int64_t kMostDistances = 16'000'000;

// Cuts a basin of the watershed that contains at least half the length of each of several rig bones: the anatomical
// bones in such a basin have grown together, or are drawn as one tube. Each voxel goes to the nearest of those rig
// bones.
void cut_where_several_bones_run(const BoneGraph& graph, const Armature& armature, const Grid& grid,
                                 const TissueVoxels& tissue, const Hugging& hugging, std::vector<std::int32_t>& basin) {
  constexpr double kMostOfItsLength = 0.5;
  const AffineTransform from_world = voxel_from_world(grid);
  std::map<std::int32_t, std::vector<int>> bones_inside;
  for (int b = 0; b < hugging.bone_count(); ++b) {
    const glm::dvec3 head = from_world * armature.bones[b].head, tail = from_world * armature.bones[b].tail;
    // At most this many points are sampled along a rig bone, which may be far longer than the volume.
    constexpr int kMostSteps = 4096;
    const int steps = static_cast<int>(std::clamp(2 * glm::length(tail - head), 8.0, double(kMostSteps)));
    std::map<std::int32_t, int> inside;
    for (int k = 0; k <= steps; ++k) {
      const glm::dvec3 at = glm::mix(head, tail, double(k) / steps);
      if (!(glm::all(glm::greaterThan(at, glm::dvec3(-0.5))) &&
            glm::all(glm::lessThan(at, glm::dvec3(grid.size) - 0.5))))
        continue;
      const std::int64_t place = tissue.index_of(glm::ivec3(glm::floor(at + 0.5)));
      const auto found = std::lower_bound(graph.place.begin(), graph.place.end(), place);
      if (found != graph.place.end() && *found == place) ++inside[basin[found - graph.place.begin()]];
    }
    for (auto [which, count] : inside)
      if (count >= kMostOfItsLength * (steps + 1)) bones_inside[which].push_back(b);
  }

  std::int32_t next = basin.empty() ? 0 : *std::max_element(basin.begin(), basin.end()) + 1;
  std::map<std::int32_t, std::int32_t> first_of;  // number of the first new basin of each basin that is cut
  for (const auto& [which, bones] : bones_inside)
    if (bones.size() >= 2) first_of[which] = std::exchange(next, next + static_cast<std::int32_t>(bones.size()));
  if (first_of.empty()) return;
  for (std::int64_t i = 0; i < graph.size(); ++i) {
    const auto cut = first_of.find(basin[i]);
    if (cut == first_of.end()) continue;
    const std::vector<int>& bones = bones_inside[cut->first];
    int best = 0;
    double nearest = std::numeric_limits<double>::max();
    for (size_t k = 0; k < bones.size(); ++k)
      if (const double d = hugging.parting_distance(bones[k], graph.voxel[i]); d < nearest)
        nearest = d, best = static_cast<int>(k);
    basin[i] = cut->second + best;
  }
}

// Joins touching basins of the watershed to pieces that each follow one rig bone, the basins with the strongest contact
// first. Two basins are not joined if the smaller one would then follow a rig bone that is much farther away than its
// own nearest one.
class Pieces {
 public:
  //   beyond      voxels on the far side of a joint, as seen from a rig bone
  //   may_follow  returns the rig bones that the basin of a given voxel may follow; empty: any
  Pieces(const BoneGraph& graph, const std::vector<float>& height, const Hugging& hugging,
         const std::vector<std::int32_t>& basin, const std::vector<BeyondJoint>& beyond, double voxel,
         const std::vector<ShoulderGirdle>& girdles, const auto& may_follow)
      : bones_(hugging.bone_count()),
        surface_(static_cast<float>(voxel / 2)),
        girdles_(girdles) {
    const auto members = members_of(basin);
    cluster_.resize(members.size());
    for (size_t p = 0; p < members.size(); ++p) {
      Cluster& cluster = cluster_[p];
      cluster.parent = static_cast<std::int32_t>(p);
      cluster.voxels = std::ssize(members[p]);
      for (std::int32_t i : members[p]) cluster.summit = std::max(cluster.summit, height[i]);
      if (members[p].empty()) continue;
      // 256 evenly spread voxels give the mean distance of all voxels with an error of a few percent.
      const size_t stride = std::max<size_t>(1, members[p].size() / 256);
      const size_t samples = (members[p].size() + stride - 1) / stride;
      cluster.distance.resize(bones_);
      for (int b = 0; b < bones_; ++b) {
        double sum = 0;
        for (size_t k = 0; k < members[p].size(); k += stride) sum += hugging.distance(b, graph.voxel[members[p][k]]);
        cluster.distance[b] = static_cast<float>(sum / samples);
      }
      for (const ShoulderGirdle& girdle : girdles_) {
        double nearest = std::numeric_limits<double>::infinity();
        std::int64_t before = 0, across = 0;
        for (const std::int32_t i : members[p]) {
          const glm::dvec3 place = hugging.world(glm::dvec3(graph.voxel[i]));
          nearest = std::min(nearest, glm::distance(girdle.shoulder, place));
          before += girdle.begins_beyond(place);
          across += girdle.is_on_other_side(place);
        }
        cluster.to_shoulder.push_back(static_cast<float>(nearest));
        if (double(before) > kMostlyBefore * double(cluster.voxels) ||
            double(across) > kAcross * double(cluster.voxels))
          before_[static_cast<std::int32_t>(p)].push_back(girdle.bone);
      }
      if (const std::vector<int>& allowed = may_follow(members[p].front()); !allowed.empty())
        for (int b = 0; b < bones_; ++b)
          if (std::find(allowed.begin(), allowed.end(), b) == allowed.end()) cluster.distance[b] += kForbidden;
    }
    move_beyond_joints(basin, beyond);
    for (std::int32_t i = 0; i < graph.size(); ++i)
      for (std::int32_t n : graph.neighbour[i]) {
        if (n <= i || basin[n] == basin[i]) continue;
        const float pass = std::min(height[i], height[n]);
        touch(basin[i], basin[n], pass);
        touch(basin[n], basin[i], pass);
      }
  }

  void join() {
    using Entry = std::tuple<float, std::int32_t, std::int32_t>;
    std::priority_queue<Entry> queue;
    auto offer = [&](std::int32_t a, std::int32_t b, float pass) {
      const float strength = (pass - surface_) / (std::min(cluster_[a].summit, cluster_[b].summit) - surface_);
      if (strength >= kWeakestContact) queue.push({strength, std::max(a, b), std::min(a, b)});
    };
    for (std::int32_t a = 0; a < std::ssize(cluster_); ++a)
      for (auto [b, pass] : cluster_[a].contact)
        if (a < b) offer(a, b, pass);
    while (!queue.empty()) {
      const auto [strength, x, y] = queue.top();
      queue.pop();
      if (cluster_[x].parent != x || cluster_[y].parent != y || !agree(x, y)) continue;
      const bool x_larger = cluster_[x].contact.size() >= cluster_[y].contact.size();
      const std::int32_t a = x_larger ? x : y, b = x_larger ? y : x;
      absorb(a, b);
      for (auto [n, pass] : cluster_[a].contact) offer(a, n, pass);
    }
  }

  std::int32_t root(std::int32_t p) const {
    while (cluster_[p].parent != p) p = cluster_[p].parent;
    return p;
  }
  // Returns the rig bone of a basin, after settle(). -1: the basin touches no other basin and is far from every rig
  // bone.
  int bone(std::int32_t p) const {
    const int bone = bone_[root(p)];
    const auto before = before_.find(p);
    if (before == before_.end() ||
        std::find(before->second.begin(), before->second.end(), bone) == before->second.end())
      return bone;
    return std::find_if(girdles_.begin(), girdles_.end(),
                        [&](const ShoulderGirdle& girdle) { return girdle.bone == bone; })
        ->trunk;
  }

  // Assigns a rig bone to every piece (group of joined basins). The own piece of a rig bone is the piece that lies
  // along the bone. The distance of a piece is that from its nearest rig bone.
  //   - A piece follows its nearest rig bone if its distance is at most 1.5 times that of the bone's own piece.
  //   - A piece that is further away (a rib beside the hanging arm, the breastbone between two collarbones) follows its
  //     nearest rig bone only if all pieces that it touches follow this bone, its parent or its children. Otherwise the
  //     piece follows a bone of the pieces that it touches: the nearest one if these bones form a chain, or their
  //     common ancestor.
  //   - A piece follows a bone of the pieces that it touches also if its distance is more than three times that of the
  //     own piece, it does not touch the own piece, and it either is much smaller than the own piece or touches no
  //     piece of the bone's parent. (So a toe beside another toe keeps its nearest bone.)
  //   - A piece that is nearest to a shoulder's rig bone may belong to the trunk (shoulder_girdles.h).
  void settle(const Armature& armature) {
    const auto count = static_cast<std::int32_t>(cluster_.size());
    bone_.assign(count, -1);
    std::vector<double> claim(bones_, 0);
    own_.assign(bones_, {});
    auto is_piece = [&](std::int32_t p) { return cluster_[p].parent == p && cluster_[p].voxels > 0; };
    for (std::int32_t p = 0; p < count; ++p) {
      if (!is_piece(p)) continue;
      const int b = best(cluster_[p]);
      const double d = std::max(1e-3, double(cluster_[p].distance[b]));
      if (const double c = cluster_[p].voxels / (d * d); c > claim[b])
        claim[b] = c, own_[b] = {d, cluster_[p].voxels, p};
    }
    std::vector<std::int32_t> waiting;
    for (std::int32_t p = 0; p < count; ++p) {
      if (!is_piece(p)) continue;
      const int b = best(cluster_[p]);
      if (const int trunk = trunk_instead_of(b, p); trunk >= 0) bone_[p] = trunk;
      else if (cluster_[p].distance[b] <= 1.5 * own_[b].distance) bone_[p] = b;
      else waiting.push_back(p);
    }
    for (bool settled = true; settled;) {
      settled = false;
      // Rig bones are assigned only after this loop, so that the order of the pieces does not matter.
      std::vector<std::pair<std::int32_t, int>> found;
      for (std::int32_t p : waiting)
        if (bone_[p] < 0)
          if (const int b = bone_of_touched(p, armature); b >= 0) found.push_back({p, b});
      for (auto [p, b] : found) bone_[p] = b, settled = true;
    }
  }
  // Returns the mean distance from a piece's voxels to each rig bone, mm.
  const std::vector<float>& distances(std::int32_t p) const { return cluster_[root(p)].distance; }

 private:
  // Two basins are joined only if the height of the pass between them is at least this share of the lower basin's
  // summit. A lower pass is a joint, a higher one a narrow place of one bone. Marrow raises passes, and it runs through
  // a bone but never across a joint. So the end of a bone is joined to its own shaft and not to the next bone, even in
  // coarse volumes.
  static constexpr float kWeakestContact = 0.35f;
  // For voxels beyond a joint, the distance to the rig bone before the joint is multiplied by 1 + this factor.
  static constexpr double kBeyondJoint = 4;
  static constexpr float kForbidden = 1e6f;  // mm added to the distance from rig bones that a basin must not follow
  // A basin does not follow a collarbone if more than this share of the basin's voxels is before the head of the
  // collarbone's rig bone, measured along this rig bone.
  static constexpr double kMostlyBefore = 0.7;
  // A basin of the watershed does not follow a collarbone if more than this share of the basin's voxels is on the
  // opposite side of the body from that collarbone. Such a basin also contains the breastbone: the labels join the two.
  static constexpr double kAcross = 0.35;
  // Limits for a piece, relative to the own piece of the same rig bone. A piece is far if its distance from the bone is
  // more than kFar times the own piece's. It is small if it has less than 1 / kSmall of the own piece's voxels.
  static constexpr double kFar = 3, kSmall = 4;

  struct Cluster {
    std::int32_t parent = 0;
    std::int64_t voxels = 0;
    float summit = 0;
    std::vector<float> distance;            // mean distance from the voxels to each rig bone, mm
    std::vector<float> to_shoulder;         // distance from the nearest voxel to each shoulder joint, mm
    std::map<std::int32_t, float> contact;  // for each touching cluster, the height of the highest pass to it
  };

  static bool above(const Armature& armature, int ancestor, int bone) {
    while (bone > ancestor) bone = armature.bones[bone].parent;
    return bone == ancestor;
  }
  // Returns the trunk's rig bone for a piece whose nearest rig bone is a shoulder's, if the piece is not that bone's
  // own piece and does not reach the shoulder joint. Returns -1 for other pieces.
  int trunk_instead_of(int bone, std::int32_t p) const {
    for (std::size_t g = 0; g < girdles_.size(); ++g) {
      const ShoulderGirdle& girdle = girdles_[g];
      const bool may_follow = cluster_[p].distance[girdle.trunk] < kForbidden;
      if (girdle.bone == bone && own_[bone].piece != p && cluster_[p].to_shoulder[g] > girdle.reach && may_follow)
        return girdle.trunk;
    }
    return -1;
  }

  int bone_of_touched(std::int32_t p, const Armature& armature) const {
    std::vector<int> touched;
    for (auto [n, pass] : cluster_[p].contact)
      if (bone_[n] >= 0) touched.push_back(bone_[n]);
    if (touched.empty()) return -1;
    std::sort(touched.begin(), touched.end());
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
    const int own = best(cluster_[p]);
    auto joined = [&](int b) { return b == own || armature.bones[b].parent == own || armature.bones[own].parent == b; };
    const auto beside = [&](int b) { return armature.bones[own].parent == b; };
    const Own& along = own_[own];
    const bool is_far = cluster_[p].distance[own] > kFar * along.distance &&
                        (kSmall * double(cluster_[p].voxels) < double(along.voxels) ||
                         std::none_of(touched.begin(), touched.end(), beside));
    const bool touches_own = std::binary_search(touched.begin(), touched.end(), own);
    if ((touches_own || !is_far) && std::all_of(touched.begin(), touched.end(), joined)) return own;
    bool chain = true;
    for (size_t k = 1; k < touched.size(); ++k) chain &= above(armature, touched[k - 1], touched[k]);
    int nearest = touched[0];
    for (int b : touched)
      if (cluster_[p].distance[b] < cluster_[p].distance[nearest]) nearest = b;
    if (chain) return nearest;
    for (int spring = touched[0]; spring >= 0; spring = armature.bones[spring].parent) {
      bool all = true;
      for (int b : touched) all &= above(armature, spring, b);
      if (all) return spring;
    }
    return nearest;
  }

  // Corrects the mean distances from basins to rig bones for voxels beyond a joint, which do not belong to the rig bone
  // before the joint but may belong to the one on its far side. Lowers the distance to the far bone to that to the bone
  // before the joint, and then raises the latter. Both change in proportion to the share of such voxels in the basin.
  void move_beyond_joints(const std::vector<std::int32_t>& basin, const std::vector<BeyondJoint>& beyond) {
    // Number of voxels beyond a joint, by basin, rig bone before the joint and rig bone beyond the joint.
    std::map<std::tuple<std::int32_t, int, int>, std::int64_t> voxels;
    for (const BeyondJoint& b : beyond) ++voxels[{basin[b.voxel], b.bone, b.other}];
    auto share_of = [&](std::int32_t p, std::int64_t count) {
      return std::min(1.0, double(count) / double(cluster_[p].voxels));
    };
    for (const auto& [where, count] : voxels) {
      const auto [p, before, other] = where;
      std::vector<float>& distance = cluster_[p].distance;
      if (distance[before] < distance[other])
        distance[other] += static_cast<float>(share_of(p, count) * (distance[before] - distance[other]));
    }
    std::map<std::pair<std::int32_t, int>, std::int64_t> before_joint;
    for (const auto& [where, count] : voxels) before_joint[{std::get<0>(where), std::get<1>(where)}] += count;
    for (const auto& [where, count] : before_joint)
      cluster_[where.first].distance[where.second] *=
          static_cast<float>(1 + kBeyondJoint * share_of(where.first, count));
  }

  void touch(std::int32_t a, std::int32_t b, float pass) {
    float& highest = cluster_[a].contact[b];
    highest = std::max(highest, pass);
  }
  static int best(const Cluster& c) {
    return static_cast<int>(std::min_element(c.distance.begin(), c.distance.end()) - c.distance.begin());
  }
  std::vector<float> joined_distance(const Cluster& a, const Cluster& b) const {
    std::vector<float> joined(bones_);
    const double share = double(b.voxels) / (a.voxels + b.voxels);
    for (int k = 0; k < bones_; ++k)
      joined[k] = static_cast<float>(a.distance[k] + share * (b.distance[k] - a.distance[k]));
    return joined;
  }
  bool agree(std::int32_t x, std::int32_t y) const {
    const Cluster &a = cluster_[x], &b = cluster_[y];
    const int of_a = best(a), of_b = best(b);
    if (of_a == of_b) return true;
    const std::vector<float> joined = joined_distance(a, b);
    const double together = *std::min_element(joined.begin(), joined.end()) * (a.voxels + b.voxels);
    const double apart = a.distance[of_a] * a.voxels + b.distance[of_b] * b.voxels;
    const Cluster& smaller = a.voxels < b.voxels ? a : b;
    const double own = smaller.distance[a.voxels < b.voxels ? of_a : of_b];
    // When two pieces are joined, the distance of the smaller one from its rig bone may grow by at most a quarter. This
    // limit lets the ball of a joint join its shaft, but keeps a finger bone separate from its neighbour.
    return together - apart <= 0.25 * own * smaller.voxels;
  }
  void absorb(std::int32_t a, std::int32_t b) {
    cluster_[a].distance = joined_distance(cluster_[a], cluster_[b]);
    for (std::size_t g = 0; g < girdles_.size(); ++g)
      cluster_[a].to_shoulder[g] = std::min(cluster_[a].to_shoulder[g], cluster_[b].to_shoulder[g]);
    cluster_[a].voxels += cluster_[b].voxels;
    cluster_[a].summit = std::max(cluster_[a].summit, cluster_[b].summit);
    cluster_[b].parent = a;
    for (auto [n, pass] : cluster_[b].contact) {
      cluster_[n].contact.erase(b);
      if (n == a) continue;
      touch(a, n, pass);
      touch(n, a, pass);
    }
    cluster_[a].contact.erase(b);
    cluster_[b] = Cluster();
    cluster_[b].parent = a;
  }

  // A rig bone's own piece, which lies along it: the piece with the largest ratio of voxels to squared distance.
  struct Own {
    double distance = 0;  // mean distance from the piece to the rig bone, mm
    std::int64_t voxels = 0;
    std::int32_t piece = -1;
  };

  int bones_;
  // Depth at the bone's surface, mm: half a voxel, since depths are measured to the centres of voxels outside the bone.
  float surface_;
  std::vector<Cluster> cluster_;
  std::vector<int> bone_;  // rig bone of each cluster; -1: none yet
  std::vector<Own> own_;   // own piece of each rig bone
  std::vector<ShoulderGirdle> girdles_;
  std::map<std::int32_t, std::vector<int>> before_;  // for each basin, the rig bones of shoulders that it cannot follow
};

// Returns the rig bone that each basin follows. A basin is a piece of bone tissue around a local maximum of depth.
std::vector<int> bones_of_basins(const BoneGraph& graph, const TissueVoxels& tissue, const LabelVolume& volume,
                                 const std::vector<std::int32_t>& basin, const Pieces& pieces) {
  const std::int32_t basins = *std::max_element(basin.begin(), basin.end()) + 1;
  std::vector<int> bone(basins);
  std::map<std::int32_t, std::vector<glm::ivec3>> lonely;  // for each piece without a rig bone, its voxels
  for (std::int32_t p = 0; p < basins; ++p) bone[p] = pieces.bone(p);
  for (std::int64_t i = 0; i < graph.size(); ++i)
    if (bone[basin[i]] < 0) lonely[pieces.root(basin[i])].push_back(graph.voxel[i]);

  const auto bone_at = [&](std::int64_t place) {
    const auto at = std::lower_bound(graph.place.begin(), graph.place.end(), place);
    return at != graph.place.end() && *at == place ? bone[basin[at - graph.place.begin()]] : -1;
  };
  std::vector<int> found(basins, -1);
  std::int64_t budget = 20'000'000;  // upper limit on the number of voxels that all searches together may visit
  for (auto& [piece, voxels] : lonely)
    found[piece] = bone_of_lonely_piece(volume, tissue, std::move(voxels), pieces.distances(piece), bone_at, budget);
  for (std::int32_t p = 0; p < basins; ++p)
    if (bone[p] < 0) bone[p] = found[pieces.root(p)];
  return bone;
}

struct ShapeBones {
  std::vector<int> bone;  // rig bone of each voxel of the graph
  std::vector<BroadCut> broad_cuts;
};
// Finds the rig bone of every voxel by shape: cuts touching bones apart at the rig's joints, splits the bone tissue
// into basins by a watershed, and joins the basins to pieces that each follow one rig bone.
//   group  index in `candidates` for each voxel of the graph
ShapeBones bones_by_shape(BoneGraph graph, const LabelVolume& volume, const TissueVoxels& tissue,
                          const std::vector<TissueKind>& kinds, const Armature& armature, const Hugging& hugging,
                          const std::vector<std::int32_t>& group, const std::vector<std::vector<int>>& candidates,
                          Progress& progress) {
  JointCuts cuts = cut_at_joints(graph, volume, kinds, armature, group, candidates, progress);
  // Doubles the height (depth inside bone) of marrow, so that two marrow cores form two summits however thin the bone
  // shells between them are.
  std::vector<float> height = cuts.depth;
  for (std::int64_t i = 0; i < graph.size(); ++i)
    if (kinds[volume.at(graph.voxel[i])] == TissueKind::Marrow) height[i] *= 2;
  progress.update("bones", 0.6);

  const double voxel = std::min({volume.grid.spacing.x, volume.grid.spacing.y, volume.grid.spacing.z});
  std::vector<std::int32_t> basin = flood(graph, height, kWiggleVoxels * voxel);
  cut_where_several_bones_run(graph, armature, volume.grid, tissue, hugging, basin);
  for (std::int64_t fewest = 8;; fewest *= 2) {
    join_specks(graph, fewest, basin);
    const std::int64_t basins = *std::max_element(basin.begin(), basin.end()) + 1;
    if (basins * hugging.bone_count() <= kMostDistances || fewest > graph.size()) break;
  }
  progress.update("bones", 0.8);

  Pieces pieces(graph, height, hugging, basin, cuts.beyond, voxel, shoulder_girdles(armature),
                [&](std::int32_t i) -> const std::vector<int>& { return candidates[group[i]]; });
  pieces.join();
  pieces.settle(armature);
  const std::vector<int> of_basin = bones_of_basins(graph, tissue, volume, basin, pieces);
  std::vector<int> bone(graph.size());
  for (std::int64_t i = 0; i < graph.size(); ++i) {
    bone[i] = of_basin[basin[i]];
    // A piece that touches no other piece got the nearest rig bone. If the name of a voxel's label does not allow that
    // bone, the voxel gets the nearest rig bone that the name allows.
    const std::vector<int>& allowed = candidates[group[i]];
    if (!allowed.empty() && std::find(allowed.begin(), allowed.end(), bone[i]) == allowed.end())
      bone[i] = *std::min_element(allowed.begin(), allowed.end(), [&](int a, int b) {
        return hugging.distance(a, graph.voxel[i]) < hugging.distance(b, graph.voxel[i]);
      });
  }
  return {std::move(bone), std::move(cuts.broad)};
}

}  // namespace

BoneParts split_bones(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
                      const Armature& armature, Progress& progress, const BoneMap& map) {
  BoneParts result;
  result.part_of.resize(tissue.size());
  progress.update("bones", 0);
  const std::vector<TissueKind> kinds = tissues.kinds();
  const auto labels = bones_of_labels(tissues, armature, map);
  const BoneGraph graph = gather_bone(volume, tissue, kinds);
  if (graph.size() == 0) return result;
  progress.update("bones", 0.4);
  const Hugging hugging(armature, volume.grid);
  NamedBones named = assign_named_bones(graph, volume, kinds, armature, labels);
  if (Unsettled unsettled = unsettled_part(graph, named); !unsettled.from.empty()) {
    std::vector<std::int32_t> group;
    for (const std::int32_t i : unsettled.from) group.push_back(named.group[i]);
    ShapeBones found = bones_by_shape(std::move(unsettled.graph), volume, tissue, kinds, armature, hugging, group,
                                      named.candidates, progress);
    for (std::size_t k = 0; k < found.bone.size(); ++k) named.bone[unsettled.from[k]] = found.bone[k];
    result.broad_cuts = std::move(found.broad_cuts);
  }
  gather_parts(graph, hugging, named.bone, result);
  result.identities = identities_of(graph, volume, named, labels);
  progress.update("bones", 1);
  return result;
}

}  // namespace limber
