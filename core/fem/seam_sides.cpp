// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/seam_sides.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>

namespace limber {

namespace {

// Returns the bone that each tissue voxel follows most, in brick order.
std::vector<std::uint16_t> bone_of_voxels(const TissueVoxels& tissue, const SkinWeights& weights,
                                          const std::vector<int>& moves_as) {
  std::vector<std::uint16_t> bone(tissue.size());
  for (std::int64_t brick = 0; brick < std::ssize(tissue.bricks()); ++brick) {
    auto influence = weights.chunk(brick).begin();
    tissue.for_each(brick, brick + 1, [&](std::int64_t place, const glm::ivec3&) {
      bone[place] = static_cast<std::uint16_t>(moves_as[(*influence++).bone[0]]);
    });
  }
  return bone;
}

// Calls body(first, second, is_cut) for every face between two tissue voxels, given by their places in brick order.
template <class Body>
void for_each_face(const TissueVoxels& tissue, const Body& body) {
  const Seams& seams = *tissue.seams();
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    for (int axis = 0; axis < 3; ++axis) {
      glm::ivec3 next = v;
      if (++next[axis] >= seams.grid_size()[axis]) continue;
      if (const std::int64_t there = tissue.index_of(next); there >= 0) body(place, there, seams.is_cut(v, axis));
    }
  });
}

// The numbers of voxel faces at which the tissue of two bones touches: those that no seam cuts, and those on a seam.
struct Faces {
  std::int64_t joined = 0, cut = 0;
};

// Returns the side of each bone; empty if no seam separates tissue of two bones.
std::vector<std::uint16_t> sides_of_bones(const TissueVoxels& tissue, const std::vector<std::uint16_t>& bone,
                                          const std::vector<int>& moves_as) {
  const std::size_t count = moves_as.size();
  std::vector<Faces> between(count * count);
  bool any = false;
  for_each_face(tissue, [&](std::int64_t first, std::int64_t second, bool is_cut) {
    if (bone[first] == bone[second]) return;
    const auto [a, b] = std::minmax(bone[first], bone[second]);
    any |= is_cut;
    ++(is_cut ? between[a * count + b].cut : between[a * count + b].joined);
  });
  if (!any) return {};

  std::vector<std::uint16_t> side(count);
  std::iota(side.begin(), side.end(), std::uint16_t{0});
  // Minus the number of joined faces of two bones, and the bones.
  std::vector<std::tuple<std::int64_t, std::size_t, std::size_t>> joined;
  for (std::size_t a = 0; a < count; ++a)
    for (std::size_t b = a + 1; b < count; ++b)
      if (const Faces& faces = between[a * count + b]; faces.joined > 0) joined.push_back({-faces.joined, a, b});
  std::sort(joined.begin(), joined.end());
  for (const auto& [faces, first, second] : joined) {
    const auto [kept, lost] = std::minmax(side[first], side[second]);
    if (kept == lost) continue;
    bool are_apart = false;
    for (std::size_t a = 0; a < count && !are_apart; ++a)
      for (std::size_t b = a + 1; b < count && !are_apart; ++b)
        are_apart = between[a * count + b].cut > 0 && std::minmax(side[a], side[b]) == std::minmax(kept, lost);
    if (!are_apart) std::replace(side.begin(), side.end(), std::uint16_t{lost}, std::uint16_t{kept});
  }
  // Numbers the sides from 0, in the order of the bones. A bone that moves as another one gets that bone's side.
  std::vector<std::uint16_t> number(count, 0);
  for (std::size_t b = 0; b < count; ++b) side[b] = side[moves_as[b]];
  std::uint16_t next = 0;
  for (std::size_t b = 0; b < count; ++b)
    if (side[b] == b) number[b] = next++;
  for (std::uint16_t& each : side) each = number[each];
  return side;
}

// Gives small islands to the side around them. An island is connected tissue of one side, without bone, that is not the
// largest of its side: it would lie loose once the sides are cut apart.
//   has_bone  #tissue voxels: 1 for voxels of bone tissue
void join_islands(const TissueVoxels& tissue, const std::vector<char>& has_bone, std::vector<std::uint16_t>& side) {
  std::vector<std::int32_t> parent(tissue.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::int64_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return static_cast<std::int32_t>(i);
  };
  for_each_face(tissue, [&](std::int64_t first, std::int64_t second, bool is_cut) {
    if (is_cut || side[first] != side[second]) return;
    const auto [low, high] = std::minmax({root(first), root(second)});
    parent[high] = low;
  });
  struct Island {
    std::int64_t voxels = 0;
    bool holds_bone = false;
    std::map<std::uint16_t, std::int64_t> faces;  // numbers of uncut faces to each other side
  };
  std::map<std::int32_t, Island> islands;
  for (std::int64_t i = 0; i < tissue.size(); ++i) {
    Island& island = islands[root(i)];
    ++island.voxels;
    island.holds_bone |= has_bone[i] != 0;
  }
  std::map<std::uint16_t, std::pair<std::int64_t, std::int32_t>> largest;  // of each side: (voxels, root)
  for (const auto& [at, island] : islands) {
    auto& known = largest[side[at]];
    if (island.voxels > known.first) known = {island.voxels, at};
  }
  std::erase_if(islands, [&](const auto& each) {
    return each.second.holds_bone || largest[side[each.first]].second == each.first;
  });
  if (islands.empty()) return;
  for_each_face(tissue, [&](std::int64_t first, std::int64_t second, bool is_cut) {
    if (is_cut || side[first] == side[second]) return;
    for (const auto& [of, next] : {std::pair{first, second}, std::pair{second, first}})
      if (const auto island = islands.find(root(of)); island != islands.end()) ++island->second.faces[side[next]];
  });
  std::map<std::int32_t, std::uint16_t> becomes;
  for (const auto& [at, island] : islands) {
    const auto most = std::max_element(island.faces.begin(), island.faces.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    if (most != island.faces.end()) becomes[at] = most->first;
  }
  for (std::int64_t i = 0; i < tissue.size(); ++i)
    if (const auto to = becomes.find(root(i)); to != becomes.end()) side[i] = to->second;
}

// Returns the joints at which a bone and the nearest of its ancestors that has tissue lie on different sides.
std::vector<SeamSides::Joint> joints_of(const Armature& armature, const SkinWeights& weights,
                                        const std::vector<std::uint16_t>& side_of_bone,
                                        const std::vector<char>& has_tissue) {
  std::vector<int> column(armature.bones.size(), -1);  // index of each bone of the rig in `weights`
  for (int i = 0; i < std::ssize(weights.bones()); ++i)
    if (const auto bone = armature.find(weights.bones()[i]); bone && has_tissue[i]) column[*bone] = i;
  std::vector<SeamSides::Joint> joints;
  for (std::size_t b = 0; b < armature.bones.size(); ++b) {
    if (column[b] < 0) continue;
    int above = armature.bones[b].parent;
    while (above >= 0 && column[above] < 0) above = armature.bones[above].parent;
    if (above < 0) continue;
    const std::uint16_t mine = side_of_bone[column[b]], other = side_of_bone[column[above]];
    if (mine != other) joints.push_back({armature.bones[b].head, mine, other});
  }
  return joints;
}

}  // namespace

SeamSides sides_of_seams(const LabelVolume& volume, const TissueVoxels& tissue, const LabelSet& is_bone,
                         const SkinWeights& weights, const Armature& armature, const std::vector<int>& moves_as) {
  SeamSides sides;
  if (!tissue.seams()) return sides;
  std::vector<std::uint16_t> of_voxel = bone_of_voxels(tissue, weights, moves_as);
  sides.of_bone = sides_of_bones(tissue, of_voxel, moves_as);
  if (sides.of_bone.empty()) return sides;

  std::vector<char> moves_tissue(moves_as.size(), 0), has_tissue(moves_as.size(), 0);
  for (std::uint16_t& each : of_voxel) moves_tissue[each] = 1, each = sides.of_bone[each];
  for (std::size_t b = 0; b < moves_as.size(); ++b) has_tissue[b] = moves_tissue[moves_as[b]];
  std::vector<char> has_bone(tissue.size(), 0);
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) { has_bone[place] = is_bone[volume.at(v)] != 0; });
  join_islands(tissue, has_bone, of_voxel);
  sides.of_voxel = std::move(of_voxel);
  sides.joints = joints_of(armature, weights, sides.of_bone, has_tissue);
  return sides;
}

}  // namespace limber
