// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/autorig/body_atlas.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "core/base/parallel.h"
#include "core/phantom/limbs.h"

namespace limber {

namespace {

using namespace phantom;

// Distance between atlas points on the skin, mm: on most of the body, and on hands and feet.
constexpr double kSkinStep = 13, kFineSkinStep = 5;
constexpr double kBoneStep = 9, kFineBoneStep = 3.2;
constexpr double kFar = 1e30;

// Returns points on the surface at which a signed distance is zero, at most one per cell. Each point starts at a cell
// centre near the surface and moves onto it along the gradient.
template <class Distance>
std::vector<AtlasPoint> points_on(const Box& box, double step, const Distance& distance) {
  const glm::ivec3 cells = glm::max(glm::ivec3(glm::ceil((box.high - box.low) / step)), glm::ivec3(1));
  std::vector<std::vector<AtlasPoint>> rows(cells.z);
  const auto gradient = [&](const glm::dvec3& p) {
    constexpr double e = 0.05;
    glm::dvec3 g;
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 by(0);
      by[axis] = e;
      g[axis] = (distance(p + by) - distance(p - by)) / (2 * e);
    }
    return g;
  };
  // Skips blocks of kBlock^3 cells that are far from the surface. The factor 1.25 allows for signed distances that are
  // wrong by 25 %.
  constexpr int kBlock = 4;
  const glm::ivec3 blocks = (cells + kBlock - 1) / kBlock;
  const double far = 1.25 * step * (0.5 + 0.5 * std::sqrt(3.0) * kBlock);
  parallel_for(blocks.z, 1, [&](std::int64_t begin, std::int64_t end) {
    std::vector<std::uint8_t> is_far(blocks.x * blocks.y);
    for (std::int64_t block_z = begin; block_z < end; ++block_z) {
      for (int y = 0; y < blocks.y; ++y)
        for (int x = 0; x < blocks.x; ++x)
          is_far[x + blocks.x * y] =
              std::abs(distance(box.low + step * kBlock * (glm::dvec3(x, y, block_z) + 0.5))) > far;
      const std::int64_t last = std::min<std::int64_t>(cells.z, kBlock * (block_z + 1));
      for (std::int64_t z = kBlock * block_z; z < last; ++z)
        for (int y = 0; y < cells.y; ++y)
          for (int x = 0; x < cells.x; ++x) {
            if (is_far[x / kBlock + blocks.x * (y / kBlock)]) continue;
            glm::dvec3 p = box.low + step * (glm::dvec3(x, y, z) + 0.5);
            double d = distance(p);
            if (std::abs(d) > 0.5 * step) continue;
            glm::dvec3 g = gradient(p);
            constexpr double kOn = 0.05;  // a point within this distance of the surface counts as on it, mm
            for (int k = 0; k < 3 && std::abs(d) > kOn; ++k) {
              for (int step = 0; step < 2; ++step) {
                p -= g * (d / std::max(glm::dot(g, g), 0.25));
                d = distance(p);
              }
              g = gradient(p);
            }
            if (std::abs(d) >= 0.5) continue;
            if (glm::length(g) > 0.1) rows[z].push_back({p, glm::normalize(g), 0});
          }
    }
  });
  std::vector<AtlasPoint> points;
  for (const auto& row : rows) points.insert(points.end(), row.begin(), row.end());
  return points;
}

// Finds the rig bone nearest to a point. The pelvis bone also includes the links to both hips, so that it is as wide as
// the hips.
class Carriers {
 public:
  explicit Carriers(const Armature& rig) {
    for (int b = 0; b < std::ssize(rig.bones); ++b) {
      if (rig.bones[b].name == "Jaw") continue;
      beside_.push_back({rig.bones[b], b});
      if (rig.bones[b].name.ends_with("Thigh") && rig.bones[b].parent >= 0) {
        Bone across = rig.bones[rig.bones[b].parent];
        across.tail = rig.bones[b].head + 0.3 * (rig.bones[b].head - across.head);
        beside_.push_back({across, rig.bones[b].parent});
      }
    }
  }
  int nearest(const glm::dvec3& p, const std::vector<int>& among) const {
    double least = kFar;
    int best = -1;
    for (const auto& [bone, number] : beside_) {
      if (!among.empty() && std::find(among.begin(), among.end(), number) == among.end()) continue;
      if (const double d = distance_to_bone(bone, p); d < least) least = d, best = number;
    }
    return best;
  }
  // Returns the rig bone that is the nearest one for most of the points.
  int carrier(const std::vector<AtlasPoint>& points) const {
    std::map<int, int> votes;
    for (const AtlasPoint& point : points) ++votes[nearest(point.place, {})];
    return std::max_element(votes.begin(), votes.end(), [](auto& a, auto& b) { return a.second < b.second; })->first;
  }

 private:
  std::vector<std::pair<Bone, int>> beside_;
};

bool is_fine(const std::string& bone) {
  for (const char* word : {"Hand", "Thumb", "Index", "Middle", "Ring", "Little", "Foot", "Toes"})
    if (bone.find(word) != std::string::npos) return true;
  return false;
}

// Returns the signed distance from `p` to the skin: the union of all parts of the flesh, blended as by voxelize(). Sets
// `part` to the index of the flesh part to which `p` belongs.
double skin_distance(const Anatomy& anatomy, const glm::dvec3& p, int* part = nullptr) {
  constexpr double kReach = 60;
  const Box here = Box{p, p}.grown(kReach);
  std::vector<double> at(anatomy.flesh.size(), kFar);
  for (size_t i = 0; i < at.size(); ++i)
    if (anatomy.flesh[i].solid.box.touches(here)) at[i] = anatomy.flesh[i].solid.distance(p);
  double least = kFar;
  for (size_t i = 0; i < at.size(); ++i) {
    if (at[i] == kFar) continue;
    const int parent = anatomy.flesh[i].parent;
    const double joined = smooth_min(at[i], parent < 0 ? kFar : at[parent], anatomy.flesh[i].blend);
    if (joined < least) {
      least = joined;
      if (part) *part = parent >= 0 && at[parent] < at[i] ? parent : static_cast<int>(i);
    }
  }
  return least;
}

// Adds the skin points to the atlas. A point on a limb moves with the limb's bone or one of its children, a point on
// the trunk with the nearest bone.
void add_skin(BodyAtlas& atlas, const Anatomy& anatomy, const Carriers& carriers, const Box& region) {
  for (int f = 0; f < std::ssize(anatomy.flesh); ++f) {
    const Box box = anatomy.flesh[f].solid.box.grown(8);
    const auto of_this = [&](const glm::dvec3& p) {
      if (!region.touches({p, p})) return kFar;
      // Far from a part of the flesh, the distance to this part alone is enough, and the union of all parts is not
      // computed.
      const double own = anatomy.flesh[f].solid.distance(p);
      return own > 45 ? own : skin_distance(anatomy, p);
    };
    const auto keep = [&](std::vector<AtlasPoint> points) {
      std::erase_if(points, [&](const AtlasPoint& point) {
        int part = -1;
        skin_distance(anatomy, point.place, &part);
        return part != f;
      });
      return points;
    };
    std::vector<AtlasPoint> points = keep(points_on(box, kSkinStep, of_this));
    if (points.empty()) points = keep(points_on(box, kFineSkinStep, of_this));
    if (points.empty()) continue;
    std::vector<int> among;
    if (anatomy.flesh[f].parent >= 0) {
      const int main = carriers.carrier(points);
      among.push_back(main);
      for (int b = 0; b < std::ssize(atlas.rig.bones); ++b)
        if (atlas.rig.bones[b].parent == main) among.push_back(b);
      if (is_fine(atlas.rig.bones[main].name)) points = keep(points_on(box, kFineSkinStep, of_this));
      // The flesh of a finger or toe is a single part, but its points move with several rig bones.
      if (is_fine(atlas.rig.bones[main].name)) {
        for (int b = 0; b < std::ssize(atlas.rig.bones); ++b)
          if (std::find(among.begin(), among.end(), atlas.rig.bones[b].parent) != among.end() &&
              std::find(among.begin(), among.end(), b) == among.end())
            among.push_back(b);
        for (int b = main; b >= 0 && is_fine(atlas.rig.bones[b].name); b = atlas.rig.bones[b].parent)
          among.push_back(b);
      }
    }
    for (AtlasPoint& point : points) {
      point.bone = carriers.nearest(point.place, among);
      atlas.skin.push_back(point);
    }
  }
}

void add_bones(BodyAtlas& atlas, const Anatomy& anatomy, const Carriers& carriers, const Box& region) {
  for (const BonePart& part : anatomy.bones) {
    if (!part.solid.box.touches(region)) continue;
    const auto distance = [&](const glm::dvec3& p) { return part.solid.distance(p); };
    const Box box = part.solid.box.grown(4);
    // All points of an anatomical bone move with one rig bone: the kneecap with the thigh, the heel with the foot, and
    // each phalanx or metacarpal with its own rig bone.
    std::vector<AtlasPoint> points = points_on(box, kBoneStep, distance);
    if (points.empty() || is_fine(atlas.rig.bones[carriers.carrier(points)].name))
      points = points_on(box, kFineBoneStep * 1.5, distance);
    if (points.empty()) continue;
    const int carrier = carriers.carrier(points);
    for (AtlasPoint& point : points) {
      point.bone = carrier;
      atlas.bone.push_back(point);
    }
  }
}

// Returns an atlas with the whole rig, but with points only near the rig bone `root` and its descendants (`root` empty:
// with all points).
BodyAtlas whole_atlas(const Anatomy& anatomy, const std::string& root = "") {
  // Margin around the bones of the root and its descendants, mm: larger than the thickness of flesh.
  constexpr double kAround = 150;
  Box region{glm::dvec3(kFar), glm::dvec3(-kFar)};
  std::vector<std::uint8_t> below;
  for (const Bone& bone : anatomy.armature.bones) {
    below.push_back(root.empty() || bone.name == root || (bone.parent >= 0 && below[bone.parent]));
    if (!below.back()) continue;
    region.low = glm::min(region.low, glm::min(bone.head, bone.tail));
    region.high = glm::max(region.high, glm::max(bone.head, bone.tail));
  }
  region = region.grown(kAround);
  BodyAtlas atlas;
  atlas.rig = anatomy.armature;
  const Carriers carriers(atlas.rig);
  add_skin(atlas, anatomy, carriers, region);
  add_bones(atlas, anatomy, carriers, region);
  return atlas;
}

// Returns the part of an atlas that moves with the bone `root` and its descendants. Removes "Right" from the bones'
// names.
BodyAtlas branch(const BodyAtlas& whole, const std::string& root) {
  BodyAtlas part;
  std::vector<int> number(whole.rig.bones.size(), -1);
  for (int b = 0; b < std::ssize(whole.rig.bones); ++b) {
    Bone bone = whole.rig.bones[b];
    const bool is_root = bone.name == root;
    if (!is_root && (bone.parent < 0 || number[bone.parent] < 0)) continue;
    number[b] = static_cast<int>(part.rig.bones.size());
    bone.parent = is_root ? -1 : number[bone.parent];
    if (bone.name.starts_with("Right")) bone.name = bone.name.substr(5);
    part.rig.bones.push_back(bone);
  }
  const auto take = [&](const std::vector<AtlasPoint>& from, std::vector<AtlasPoint>& to) {
    for (AtlasPoint point : from)
      if (number[point.bone] >= 0) point.bone = number[point.bone], to.push_back(point);
  };
  take(whole.skin, part.skin);
  take(whole.bone, part.bone);
  return part;
}

}  // namespace

BodyAtlas make_atlas(AtlasKind kind) {
  if (kind == AtlasKind::Arm) return whole_atlas(arm_anatomy());
  if (kind == AtlasKind::Hand) return branch(whole_atlas(arm_anatomy(), "Hand"), "Hand");
  if (kind == AtlasKind::Body) return whole_atlas(body_anatomy());
  const std::string root = kind == AtlasKind::Leg ? "RightThigh" : "RightClavicle";
  return branch(whole_atlas(body_anatomy(), root), root);
}

BodyAtlas mirrored(const BodyAtlas& atlas) {
  BodyAtlas result = atlas;
  const glm::dvec3 across(-1, 1, 1);
  for (Bone& bone : result.rig.bones) {
    bone.head *= across, bone.tail *= across;
    bone.limits.axis *= -across;  // the minus is needed because a mirror reverses the sense of rotation
  }
  for (auto* points : {&result.skin, &result.bone})
    for (AtlasPoint& point : *points) point.place *= across, point.normal *= across;
  return result;
}

}  // namespace limber
