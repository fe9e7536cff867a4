// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/soft_body.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/skin/tissue_front.h"

namespace limber {

namespace {
// Of 1 / distance^2. Beside weights painted by hand 1 to 4 do equally well; 0 (conduction alone) loses a fifth of them.
constexpr float kAttraction = 2;
// The last bone of a chain stands for all that comes after it (four fingers, the toes, the jaw), most of it further off
// than the bone is long: beyond kOwnReach of its length, distances to it count as kLastBone of what they are.
constexpr float kOwnReach = 0.5f;
constexpr float kLastBone = 0.65f;
// A bone that only links a limb to the trunk (a collarbone) stands for less than itself: what lies below it on the chest
// is the trunk's. A link is shorter than kLinkShare of the bone it leads to and turns aside where its parent forks.
constexpr float kLink = 1 / kLastBone;
constexpr double kLinkShare = 0.75;
// Flesh beyond a joint is nearest to the joint itself when its distance is this share of the way to there.
constexpr float kAtJoint = 0.75f;
// Bone that is not drawn is taken to fill this share of the flesh around its axis, a voxel's diagonal at least.
constexpr double kBoneShare = 0.5;
}  // namespace

float conductivity(TissueKind kind) {
  // W/m/K of living tissue at 37 C over muscle's 0.49.
  switch (kind) {
    case TissueKind::Skin: return 0.76f;
    case TissueKind::Fat: return 0.43f;
    case TissueKind::Connective: return 0.80f;
    case TissueKind::Nail: return 0.50f;
    case TissueKind::Brain: return 1.10f;
    case TissueKind::Blood: return 1.06f;
    default: return 1.0f;  // muscle, tendon, cartilage, nerve, vessel, organs: 0.46 to 0.52
  }
}

namespace {

// How far the air is from a bone's axis, mm: the median over points along it of the shortest of 26 rays.
double flesh_around(const Bone& bone, const LabelVolume& volume) {
  const AffineTransform from_world = voxel_from_world(volume.grid);
  const double step = std::min({volume.grid.spacing.x, volume.grid.spacing.y, volume.grid.spacing.z});
  const glm::dvec3 size(volume.grid.size);
  // A rig may lie farther from the volume than whole numbers reach.
  auto is_air = [&](const glm::dvec3& at) {
    const bool inside = glm::all(glm::greaterThanEqual(at, glm::dvec3(0))) && glm::all(glm::lessThan(at, size));
    return !inside || volume.at(glm::ivec3(at)) == 0;
  };
  constexpr int kPoints = 9;
  std::vector<double> depths;
  for (int k = 0; k < kPoints; ++k) {
    const glm::dvec3 at = glm::mix(bone.head, bone.tail, (k + 0.5) / kPoints);
    double shortest = std::numeric_limits<double>::max();
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
          if (x == 0 && y == 0 && z == 0) continue;
          const glm::dvec3 along = glm::normalize(glm::dvec3(x, y, z)) * step;
          for (int n = 0; n * step < shortest; ++n)
            if (is_air(from_world * (at + double(n) * along) + 0.5)) shortest = n * step;
        }
    depths.push_back(shortest);
  }
  std::nth_element(depths.begin(), depths.begin() + kPoints / 2, depths.end());
  return depths[kPoints / 2];
}
}  // namespace

std::vector<std::uint16_t> bone_holding(const LabelVolume& volume, const TissueVoxels& tissue, const BoneParts& parts,
                                        const Armature& armature) {
  std::vector<std::uint16_t> held_by(tissue.size(), kSoft);
  std::vector<bool> has_part(armature.bones.size(), false);
  for (const auto& part : parts.parts) has_part[part.bone] = true;
  for (std::int64_t i = 0; i < tissue.size(); ++i)
    if (parts.part_of[i]) held_by[i] = static_cast<std::uint16_t>(parts.parts[parts.part_of[i] - 1].bone);

  const AffineTransform from_voxel = world_from_voxel(volume.grid), from_world = voxel_from_world(volume.grid);
  const double voxel = std::max({volume.grid.spacing.x, volume.grid.spacing.y, volume.grid.spacing.z});
  std::vector<float> nearest(tissue.size(), -1);  // filled only where axes without a part run
  for (size_t b = 0; b < armature.bones.size(); ++b) {
    if (has_part[b]) continue;
    const Bone& bone = armature.bones[b];
    const double radius = std::max(0.87 * voxel, kBoneShare * flesh_around(bone, volume));
    glm::dvec3 lowest(1e300), highest(-1e300);
    for (const glm::dvec3& end : {bone.head, bone.tail})
      for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 at = from_world * (end + radius * glm::dvec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1));
        lowest = glm::min(lowest, at);
        highest = glm::max(highest, at);
      }
    const glm::ivec3 begin(glm::clamp(glm::floor(lowest), glm::dvec3(0), glm::dvec3(volume.grid.size)));
    const glm::ivec3 end(glm::clamp(glm::ceil(highest) + 1.0, glm::dvec3(0), glm::dvec3(volume.grid.size)));
    for (int z = begin.z; z < end.z; ++z)
      for (int y = begin.y; y < end.y; ++y)
        for (int x = begin.x; x < end.x; ++x) {
          const std::int64_t place = tissue.index_of({x, y, z});
          if (place < 0 || parts.part_of[place]) continue;
          const auto d = static_cast<float>(distance_to_bone(bone, from_voxel * glm::dvec3(x, y, z)));
          if (d > radius || (nearest[place] >= 0 && nearest[place] <= d)) continue;
          nearest[place] = d;
          held_by[place] = static_cast<std::uint16_t>(b);
        }
  }
  return held_by;
}

namespace {
glm::dvec3 along(const Bone& bone) { return bone.tail - bone.head; }

bool is_link(const Armature& armature, size_t b) {
  const Bone& bone = armature.bones[b];
  if (bone.parent < 0) return false;
  const double length = glm::length(along(bone));
  const glm::dvec3 before = along(armature.bones[bone.parent]);
  bool forks = false, leads_on = false;
  for (size_t other = 0; other < armature.bones.size(); ++other) {
    forks |= other != b && armature.bones[other].parent == bone.parent;
    leads_on |= armature.bones[other].parent == static_cast<int>(b) && length < kLinkShare * glm::length(along(armature.bones[other]));
  }
  return forks && leads_on && glm::dot(along(bone), before) < 0.5 * length * glm::length(before);
}

// How the way to a bone counts: as it is up to `reach`, beyond that by `share`.
struct Count {
  float reach = std::numeric_limits<float>::infinity();  // mm
  float share = 1;
  float operator()(float way) const { return way <= reach ? way : reach + share * (way - reach); }
};

std::vector<Count> counts_of_bones(const Armature& armature) {
  std::vector<bool> last(armature.bones.size(), true);
  for (const Bone& bone : armature.bones)
    if (bone.parent >= 0) last[bone.parent] = false;
  std::vector<Count> counts(armature.bones.size());
  for (size_t b = 0; b < counts.size(); ++b) {
    if (last[b]) counts[b] = {kOwnReach * static_cast<float>(glm::length(along(armature.bones[b]))), kLastBone};
    if (is_link(armature, b)) counts[b] = {0, kLink};
  }
  return counts;
}

// Where exactly two bones meet, flesh nearest to the joint itself lies as near to the one as to the other, and goes
// with the bone on whose side of the plane that halves their angle it lies: the heel with the foot, not with the shin.
class Hinges {
 public:
  explicit Hinges(const Armature& armature) : ends_(armature.bones.size()) {
    std::vector<bool> last(armature.bones.size(), true);
    for (const Bone& bone : armature.bones)
      if (bone.parent >= 0) last[bone.parent] = false;
    for (size_t b = 0; b < ends_.size(); ++b)
      for (int side = 0; side < 2 && !last[b]; ++side) ends_[b][side] = end_of(armature, b, side);
  }

  // The bone that flesh at `point` belongs to when `nearest` is its nearest bone, `distance` mm away.
  std::uint16_t bone_at(const glm::vec3& point, std::uint16_t nearest, float distance) const {
    for (const End& end : ends_[nearest]) {
      if (end.other < 0) continue;
      const glm::vec3 from_joint = point - end.joint;
      if (glm::dot(from_joint, end.inward) < 0 && glm::dot(from_joint, end.parting) > 0 && distance >= kAtJoint * glm::length(from_joint))
        return static_cast<std::uint16_t>(end.other);
    }
    return nearest;
  }

 private:
  struct End {
    int other = -1;  // the bone met there, -1 if none or several
    glm::vec3 joint, inward, parting;
  };
  static End end_of(const Armature& armature, size_t b, int side) {
    auto joint = [](const Bone& bone, int at) { return at ? bone.tail : bone.head; };
    auto inward = [](const Bone& bone, int at) { return glm::normalize(at ? -along(bone) : along(bone)); };
    const Bone& bone = armature.bones[b];
    const double length = glm::length(along(bone));
    End end;
    int met = 0;
    for (size_t o = 0; o < armature.bones.size(); ++o)
      for (int at = 0; at < 2; ++at) {
        const Bone& other = armature.bones[o];
        const double near = 0.05 * std::min(length, glm::length(along(other)));
        if (o == b || !(near > 0) || glm::distance(joint(bone, side), joint(other, at)) > near) continue;
        ++met;
        end = {static_cast<int>(o), joint(bone, side), inward(bone, side), inward(other, at) - inward(bone, side)};
      }
    return met == 1 ? end : End();
  }
  std::vector<std::array<End, 2>> ends_;
};
}  // namespace

namespace {
NearestBone spread_from_bones(const LabelVolume& volume, const TissueVoxels& tissue, const std::vector<std::uint16_t>& held_by,
                              const std::vector<Count>& counts) {
  NearestBone nearest{held_by, std::vector<float>(tissue.size(), std::numeric_limits<float>::infinity())};
  TissueFront front(volume, tissue);
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    if (held_by[place] == kSoft) return;
    nearest.distance[place] = 0;
    front.start(place, v);
  });
  front.spread([&](std::int64_t from, std::int64_t to, float way) {
    if (held_by[to] != kSoft) return false;
    const float distance = counts[nearest.bone[from]](way);
    if (distance >= nearest.distance[to]) return false;
    nearest.distance[to] = distance;
    nearest.bone[to] = nearest.bone[from];
    return true;
  });
  return nearest;
}
}  // namespace

NearestBone nearest_bone(const LabelVolume& volume, const TissueVoxels& tissue, const Armature& armature,
                         const std::vector<std::uint16_t>& held_by) {
  return spread_from_bones(volume, tissue, held_by, std::vector<Count>(armature.bones.size()));
}

NearestBone attracting_bone(const LabelVolume& volume, const TissueVoxels& tissue, const Armature& armature,
                            const std::vector<std::uint16_t>& held_by) {
  NearestBone nearest = spread_from_bones(volume, tissue, held_by, counts_of_bones(armature));
  const Hinges hinges(armature);
  const AffineTransform from_voxel = world_from_voxel(volume.grid);
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    if (held_by[place] == kSoft && nearest.bone[place] != kSoft)
      nearest.bone[place] = hinges.bone_at(glm::vec3(from_voxel * glm::dvec3(v)), nearest.bone[place], nearest.distance[place]);
  });
  return nearest;
}

SoftBody::SoftBody(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
                   const std::vector<std::uint16_t>& held_by, const NearestBone& nearest, const std::map<Label, double>& stiffness)
    : volume_(volume), tissue_(tissue), held_by_(held_by), nearest_(nearest), conductivity_(1 << 16, 1.0f), attraction_(1 << 16, kAttraction) {
  for (const auto& [label, stiff] : stiffness) attraction_[label] = static_cast<float>(kAttraction * stiff * stiff);
  for (const Tissue& t : tissues.tissues) conductivity_[t.label] = conductivity(t.kind);
  const glm::dvec3 s = volume.grid.spacing;
  const glm::dvec3 area_over_distance(s.y * s.z / s.x, s.x * s.z / s.y, s.x * s.y / s.z);
  const double largest = std::max({area_over_distance.x, area_over_distance.y, area_over_distance.z});
  for (int axis = 0; axis < 3; ++axis) face_[axis] = static_cast<float>(area_over_distance[axis] / largest);
  volume_of_voxel_ = static_cast<float>(volume.grid.voxel_volume() / largest);
}

// A brick and one layer around it: places in the tissue list, -1 for air.
struct SoftBody::Window {
  static constexpr int kStep[3] = {1, 10, 100};
  std::array<std::int32_t, 1000> place;
  std::array<Label, 1000> label;
  const Seams* seams = nullptr;  // where one is near

  static int at(const glm::ivec3& v) { return (v.x + 1) + 10 * (v.y + 1) + 100 * (v.z + 1); }  // v from the corner

  bool is_cut(const glm::ivec3& voxel, int direction) const { return seams && seams->is_cut_towards(voxel, direction); }

  void look(const SoftBody& body, std::int64_t brick) {
    const auto& here = body.tissue_.bricks()[brick];
    seams = body.tissue_.seams();
    if (seams && !seams->is_near_brick(here.corner)) seams = nullptr;
    place.fill(-1);
    label.fill(0);
    body.tissue_.for_each(brick, brick + 1, [&](std::int64_t p, const glm::ivec3& v) {
      place[at(v - here.corner)] = static_cast<std::int32_t>(p);
      label[at(v - here.corner)] = body.volume_.at(v);
    });
    for (int axis = 0; axis < 3; ++axis)
      for (int side = -1; side <= 8; side += 9)
        for (int a = 0; a < 8; ++a)
          for (int b = 0; b < 8; ++b) {
            glm::ivec3 v;
            v[axis] = side;
            v[(axis + 1) % 3] = a;
            v[(axis + 2) % 3] = b;
            const glm::ivec3 w = here.corner + v;
            if (!body.volume_.grid.contains(w)) continue;
            const Label l = body.volume_.at(w);
            if (l == 0) continue;
            label[at(v)] = l;
            place[at(v)] = static_cast<std::int32_t>(body.tissue_.index_of(w));
          }
  }
};

// Between two soft voxels.
float SoftBody::face(std::int64_t axis, Label a, Label b) const {
  const float ka = conductivity_[a], kb = conductivity_[b];
  return face_[axis] * (ka == kb ? ka : 2 * ka * kb / (ka + kb));
}

float SoftBody::attraction(std::int64_t place, Label label) const {
  const float distance = nearest_.distance[place];
  return attraction_[label] * volume_of_voxel_ / (distance * distance);  // zero where no bone is reached
}

SoftBody::Region SoftBody::region(const std::vector<std::int32_t>& bricks) const {
  Region region;
  CellGraph& graph = region.graph;
  graph.spacing = volume_.grid.spacing;
  std::vector<std::int32_t> cell_of(tissue_.size(), -1);
  for (int colour = 0; colour < 2; ++colour) {
    for (std::int32_t brick : bricks)
      tissue_.for_each(brick, brick + 1, [&](std::int64_t place, const glm::ivec3& v) {
        if (held_by_[place] != kSoft || ((v.x + v.y + v.z) & 1) != colour) return;
        cell_of[place] = static_cast<std::int32_t>(region.place.size());
        region.place.push_back(place);
        graph.position.push_back(glm::i16vec3(v));
      });
    if (colour == 0) graph.red_count = static_cast<std::int32_t>(region.place.size());
  }

  // Faces are found brick by brick, but a cell's list lies at its number: once to count them, once to note them.
  const std::int64_t size = graph.size();
  graph.diagonal.assign(size, 0);
  graph.first.assign(size + 1, 0);
  Window window;
  for (const bool counting : {true, false}) {
    for (std::int32_t brick : bricks) {
      window.look(*this, brick);
      const glm::ivec3 corner = tissue_.bricks()[brick].corner;
      tissue_.for_each(brick, brick + 1, [&](std::int64_t place, const glm::ivec3& v) {
        const std::int32_t cell = cell_of[place];
        if (cell < 0) return;
        const int here = Window::at(v - corner);
        std::int32_t next = counting ? 0 : graph.first[cell];
        for (int direction = 0; direction < 6; ++direction) {
          const int axis = direction >> 1, there = here + (direction & 1 ? Window::kStep[axis] : -Window::kStep[axis]);
          const std::int32_t other = window.place[there];
          if (other < 0 || window.is_cut(v, direction)) continue;
          if (counting) {
            next += cell_of[other] >= 0;
            continue;
          }
          if (const std::uint16_t holder = held_by_[other]; holder != kSoft) {
            const float g = 2 * face_[axis] * conductivity_[window.label[here]];
            graph.diagonal[cell] += g;
            region.held.push_back({cell, holder, g});
            continue;
          }
          const float g = face(axis, window.label[here], window.label[there]);
          graph.diagonal[cell] += g;
          if (cell_of[other] < 0) continue;
          graph.neighbour[next] = cell_of[other];
          graph.conductance[next++] = g;
        }
        if (counting) {
          graph.first[cell + 1] = next;
        } else if (const float g = attraction(place, window.label[here]); g > 0) {
          graph.diagonal[cell] += g;
          region.held.push_back({cell, nearest_.bone[place], g});
        }
      });
    }
    if (!counting) break;
    for (std::int64_t i = 0; i < size; ++i) graph.first[i + 1] += graph.first[i];
    graph.neighbour.resize(graph.first[size]);
    graph.conductance.resize(graph.first[size]);
  }
  return region;
}

SoftBody::Coarse SoftBody::coarse() const {
  Coarse coarse;
  coarse.cell_of_place.assign(tissue_.size(), -1);
  std::vector<std::int32_t>& cell_of = coarse.cell_of_place;
  std::vector<glm::i16vec3> position;
  const std::int64_t bricks = std::ssize(tissue_.bricks());

  // Connected soft voxels of one octant are one cell.
  Window window;
  std::array<glm::ivec3, 64> open;
  for (std::int64_t brick = 0; brick < bricks; ++brick) {
    const glm::ivec3 corner = tissue_.bricks()[brick].corner;
    window.look(*this, brick);
    tissue_.for_each(brick, brick + 1, [&](std::int64_t seed, const glm::ivec3& seed_voxel) {
      if (held_by_[seed] != kSoft || cell_of[seed] >= 0) return;
      const auto cell = static_cast<std::int32_t>(position.size());
      const glm::ivec3 octant = seed_voxel >> 2;
      position.push_back(glm::i16vec3(octant));
      coarse.brick.push_back(static_cast<std::int32_t>(brick));
      cell_of[seed] = cell;
      int open_count = 0;
      open[open_count++] = seed_voxel;
      while (open_count > 0) {
        const glm::ivec3 v = open[--open_count];
        for (int direction = 0; direction < 6; ++direction) {
          glm::ivec3 w = v;
          w[direction >> 1] += direction & 1 ? 1 : -1;
          if ((w >> 2) != octant) continue;
          const std::int32_t place = window.place[Window::at(w - corner)];
          if (place < 0 || held_by_[place] != kSoft || cell_of[place] >= 0 || window.is_cut(v, direction)) continue;
          cell_of[place] = cell;
          open[open_count++] = w;
        }
      }
    });
  }

  // Colour 0 first.
  const auto size = std::ssize(position);
  CellGraph& graph = coarse.graph;
  graph.spacing = 4.0 * volume_.grid.spacing;
  std::vector<std::int32_t> number(size);
  std::vector<std::int32_t> brick_of(size);
  for (int colour = 0; colour < 2; ++colour) {
    for (std::int64_t c = 0; c < size; ++c)
      if (((position[c].x + position[c].y + position[c].z) & 1) == colour) {
        number[c] = static_cast<std::int32_t>(graph.position.size());
        brick_of[number[c]] = coarse.brick[c];
        graph.position.push_back(position[c]);
      }
    if (colour == 0) graph.red_count = static_cast<std::int32_t>(graph.position.size());
  }
  coarse.brick = std::move(brick_of);
  for (std::int32_t& c : cell_of)
    if (c >= 0) c = number[c];

  // Faces between cells add up; the way between centres is four times as long.
  struct Link {
    std::int32_t from, to;
    float conductance;
  };
  std::vector<Link> links;
  graph.diagonal.assign(size, 0);
  for (std::int64_t brick = 0; brick < bricks; ++brick) {
    const glm::ivec3 corner = tissue_.bricks()[brick].corner;
    window.look(*this, brick);
    const size_t start = links.size();
    tissue_.for_each(brick, brick + 1, [&](std::int64_t place, const glm::ivec3& v) {
      const std::int32_t cell = cell_of[place];
      if (cell < 0) return;
      const int here = Window::at(v - corner);
      for (int direction = 0; direction < 6; ++direction) {
        const int axis = direction >> 1, there = here + (direction & 1 ? Window::kStep[axis] : -Window::kStep[axis]);
        const std::int32_t other = window.place[there];
        if (other < 0 || cell_of[other] == cell || window.is_cut(v, direction)) continue;
        if (held_by_[other] != kSoft) {
          const float g = 0.5f * face_[axis] * conductivity_[window.label[here]];
          graph.diagonal[cell] += g;
          coarse.held.push_back({cell, held_by_[other], g});
        } else {
          const float g = 0.25f * face(axis, window.label[here], window.label[there]);
          graph.diagonal[cell] += g;
          links.push_back({cell, cell_of[other], g});
        }
      }
      if (const float g = attraction(place, window.label[here]); g > 0) {
        graph.diagonal[cell] += g;
        coarse.held.push_back({cell, nearest_.bone[place], g});
      }
    });
    // One entry a pair.
    std::stable_sort(links.begin() + start, links.end(), [](const Link& a, const Link& b) { return a.from != b.from ? a.from < b.from : a.to < b.to; });
    size_t kept = start;
    for (size_t i = start; i < links.size(); ++i) {
      if (kept > start && links[kept - 1].from == links[i].from && links[kept - 1].to == links[i].to)
        links[kept - 1].conductance += links[i].conductance;
      else
        links[kept++] = links[i];
    }
    links.resize(kept);
  }
  graph.first.assign(size + 1, 0);
  for (const Link& link : links) ++graph.first[link.from + 1];
  for (std::int64_t i = 0; i < size; ++i) graph.first[i + 1] += graph.first[i];
  std::vector<std::int32_t> at(graph.first.begin(), graph.first.end() - 1);
  graph.neighbour.resize(links.size());
  graph.conductance.resize(links.size());
  for (const Link& link : links) {
    graph.neighbour[at[link.from]] = link.to;
    graph.conductance[at[link.from]++] = link.conductance;
  }
  return coarse;
}

}  // namespace limber
