// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/seam_sides.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>

#include "core/base/disjoint_sets.h"

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

// Lets islands follow the bone around them that has most faces with them. Returns their voxels with the new bone.
//   has_bone  #tissue voxels: 1 for voxels of bone tissue
//   bone      #tissue voxels: the bone that each follows; changed for islands
std::vector<VoxelSides::Stray> join_islands(const TissueVoxels& tissue, const std::vector<char>& has_bone,
                                            const std::vector<std::uint16_t>& side_of_bone,
                                            std::vector<std::uint16_t>& bone) {
  const auto side = [&](std::int64_t place) { return side_of_bone[bone[place]]; };
  DisjointSets groups(tissue.size());
  for_each_face(tissue, [&](std::int64_t first, std::int64_t second, bool is_cut) {
    if (!is_cut && side(first) == side(second)) groups.unite(first, second);
  });
  struct Island {
    std::int64_t voxels = 0;
    bool holds_bone = false;
    std::map<std::uint16_t, std::int64_t> faces;  // number of uncut faces to tissue of each bone of other sides
  };
  std::map<std::int32_t, Island> islands;
  for (std::int64_t i = 0; i < tissue.size(); ++i) {
    Island& island = islands[groups.least(i)];
    ++island.voxels;
    island.holds_bone |= has_bone[i] != 0;
  }
  std::map<std::uint16_t, std::pair<std::int64_t, std::int32_t>> largest;  // for each side: (voxels, group)
  for (const auto& [at, island] : islands)
    if (auto& known = largest[side(at)]; island.voxels > known.first) known = {island.voxels, at};
  std::erase_if(islands, [&](const auto& each) {
    return each.second.holds_bone || largest[side(each.first)].second == each.first;
  });
  if (islands.empty()) return {};
  for_each_face(tissue, [&](std::int64_t first, std::int64_t second, bool is_cut) {
    if (is_cut || side(first) == side(second)) return;
    for (const auto& [of, next] : {std::pair{first, second}, std::pair{second, first}})
      if (const auto island = islands.find(groups.least(of)); island != islands.end())
        ++island->second.faces[bone[next]];
  });
  std::vector<VoxelSides::Stray> strays;
  for (std::int64_t i = 0; i < tissue.size(); ++i) {
    const auto island = islands.find(groups.least(i));
    if (island == islands.end() || island->second.faces.empty()) continue;
    const auto& faces = island->second.faces;
    const auto most =
        std::max_element(faces.begin(), faces.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    strays.push_back({i, most->first});
  }
  for (const auto& [place, follows] : strays) bone[place] = follows;
  return strays;
}

// A joint of the rig whose two bones lie on different sides.
struct SideJoint {
  glm::dvec3 place;             // position at rest, world, mm
  std::uint16_t first, second;  // the two sides
};

// Returns the joints between each bone and the nearest of its ancestors that has tissue, if their sides differ.
std::vector<SideJoint> joints_of(const Armature& armature, const SkinWeights& weights,
                                 const std::vector<std::uint16_t>& side_of_bone, const std::vector<char>& has_tissue) {
  std::vector<int> column(armature.bones.size(), -1);  // index of each bone of the rig in `weights`
  for (int i = 0; i < std::ssize(weights.bones()); ++i)
    if (const auto bone = armature.find(weights.bones()[i]); bone && has_tissue[i]) column[*bone] = i;
  std::vector<SideJoint> joints;
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

// A voxel face between two sides that no seam cuts.
struct OpenFace {
  std::int64_t first, second;  // places of the two voxels in brick order
  glm::ivec3 lower;            // the lower of the two voxels
  int axis;
};

// Returns the body's seams, with all open faces between two sides cut that hold no limb (sides_of_seams()).
//   side  #tissue voxels
std::shared_ptr<const Seams> close_gaps(const TissueVoxels& tissue, const Grid& grid,
                                        const std::vector<std::uint16_t>& side, const std::vector<SideJoint>& joints) {
  const Seams& seams = *tissue.seams();
  std::vector<OpenFace> open;
  std::vector<char> is_at_face(tissue.size(), 0);
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    for (int axis = 0; axis < 3; ++axis) {
      glm::ivec3 next = v;
      if (++next[axis] >= grid.size[axis]) continue;
      const std::int64_t there = tissue.index_of(next);
      if (there < 0 || side[there] == side[place] || seams.is_cut(v, axis)) continue;
      open.push_back({place, there, v, axis});
      is_at_face[place] = is_at_face[there] = 1;
    }
  });
  // Open faces are in one group if a path between them leads over voxels with open faces.
  DisjointSets groups(tissue.size());
  for_each_face(tissue, [&](std::int64_t first, std::int64_t second, bool is_cut) {
    if (!is_cut && is_at_face[first] && is_at_face[second]) groups.unite(first, second);
  });
  // For each group around joints: the sides that these joints attach to each other, as groups of sides.
  std::map<std::int32_t, DisjointSets> attached;
  const AffineTransform world = world_from_voxel(grid);
  for (const SideJoint& joint : joints) {
    double distance = INFINITY;
    std::int64_t nearest = -1;
    for (const OpenFace& face : open) {
      if (std::minmax(side[face.first], side[face.second]) != std::minmax(joint.first, joint.second)) continue;
      const double here = glm::distance(world * glm::dvec3(face.lower), joint.place);
      if (here < distance) distance = here, nearest = face.first;
    }
    if (nearest < 0) continue;
    DisjointSets& sides =
        attached.try_emplace(groups.least(nearest), 1 + *std::max_element(side.begin(), side.end())).first->second;
    sides.unite(joint.first, joint.second);
  }
  auto closed = std::make_shared<Seams>(seams);
  for (const OpenFace& face : open) {
    const auto sides = attached.find(groups.least(face.first));
    if (sides == attached.end() || sides->second.least(side[face.first]) != sides->second.least(side[face.second]))
      closed->cut(face.lower, face.axis);
  }
  return closed;
}

}  // namespace

VoxelSides sides_of_seams(const LabelVolume& volume, const TissueVoxels& tissue, const LabelSet& is_bone,
                          const SkinWeights& weights, const Armature& armature, const std::vector<int>& moves_as) {
  VoxelSides result;
  if (!tissue.seams()) return result;
  std::vector<std::uint16_t> bone = bone_of_voxels(tissue, weights, moves_as);
  std::vector<std::uint16_t> side_of_bone = sides_of_bones(tissue, bone, moves_as);
  if (side_of_bone.empty()) return result;

  std::vector<char> moves_tissue(moves_as.size(), 0), has_tissue(moves_as.size(), 0);
  for (const std::uint16_t each : bone) moves_tissue[each] = 1;
  for (std::size_t b = 0; b < moves_as.size(); ++b) has_tissue[b] = moves_tissue[moves_as[b]];
  std::vector<char> has_bone(tissue.size(), 0);
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) { has_bone[place] = is_bone[volume.at(v)] != 0; });
  result.strays = join_islands(tissue, has_bone, side_of_bone, bone);
  for (const std::uint16_t each : bone) result.of_voxel.push_back(side_of_bone[each]);
  result.sides.seams =
      close_gaps(tissue, volume.grid, result.of_voxel, joints_of(armature, weights, side_of_bone, has_tissue));
  result.sides.of_bone = std::move(side_of_bone);
  return result;
}

SkinWeights without_strays(SkinWeights weights, const TissueVoxels& tissue,
                           const std::vector<VoxelSides::Stray>& strays) {
  for (std::size_t i = 0; i < strays.size();) {
    const auto brick = std::upper_bound(tissue.bricks().begin(), tissue.bricks().end(), strays[i].place,
                                        [](std::int64_t place, const auto& each) { return place < each.first; }) -
                       tissue.bricks().begin() - 1;
    SkinWeights::Influences chunk = weights.chunk(brick);
    const std::int64_t first = tissue.bricks()[brick].first;
    for (; i < strays.size() && strays[i].place < first + std::ssize(chunk); ++i)
      chunk[strays[i].place - first] = rigid_influence(strays[i].bone);
    weights.set_chunk(brick, std::move(chunk));
  }
  return weights;
}

}  // namespace limber
