// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/phantom/anatomy.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "core/base/parallel.h"

namespace limber::phantom {

namespace {
constexpr double kSkinThickness = 1.8;  // thickness of the skin (dermis and epidermis) of an adult's limb, mm
// A point becomes cartilage if the sum of its distances to two bones is less than this, mm.
constexpr double kJointGap = 5;
constexpr double kMuscleReach = 7;  // a point below the fat that is further than this from every muscle is fat, mm
constexpr double kMostFat = 40;     // upper limit on Flesh::fat, the thickness of the fat layer, in all parts, mm
constexpr int kBlock = 8;           // edge of the blocks in which the volume is filled, voxels
constexpr int kMargin = 3;          // width of the air around the body, voxels
constexpr std::int64_t kMostVoxels = std::int64_t{1} << 30;
constexpr double kFar = 1e30;
// Safety factor on a block's radius when shapes too far from the block's centre are left out. It is needed because the
// distances of lofts and ellipsoids are not exact.
constexpr double kSlack = 1.5;

// Indices of the shapes of each kind that may contain voxels of one block.
struct Nearby {
  bool deep = false;  // true: the whole block lies below skin and fat
  std::vector<int> flesh, bones, inner, muscles, nails;
};

struct Depth {
  double surface;  // signed distance to the skin's outer surface, negative inside, mm
  double fat;      // thickness of the fat, mm
};

// Computes the depth of a point below the skin's surface. Each part of the flesh (such as a finger) is blended smoothly
// with its parent part (the palm) only.
//   at  working memory, which receives the distance to each part in `nearby`
Depth depth_at(const Anatomy& anatomy, const std::vector<int>& nearby, const glm::dvec3& p, std::vector<double>& at) {
  for (int i : nearby) at[i] = anatomy.flesh[i].solid.distance(p);
  Depth depth{kFar, 0};
  for (int i : nearby) {
    const Flesh& flesh = anatomy.flesh[i];
    const double own = at[i], other = flesh.parent < 0 ? kFar : at[flesh.parent];
    const double joined = smooth_min(own, other, flesh.blend);
    if (joined >= depth.surface) continue;
    const double share = flesh.parent < 0 ? 0 : std::clamp(0.5 + 0.5 * (own - other) / flesh.blend, 0.0, 1.0);
    depth = {joined, flesh.fat + share * (flesh.parent < 0 ? 0 : anatomy.flesh[flesh.parent].fat - flesh.fat)};
  }
  for (int i : nearby) at[i] = kFar;
  return depth;
}

Nearby shapes_near(const Anatomy& anatomy, const glm::dvec3& centre, double radius, std::vector<double>& at) {
  const Box block = Box{centre, centre}.grown(radius);
  Nearby nearby;
  // A smooth union needs the distances to both of its shapes, so shapes within the blend width of the block are kept.
  // The union's surface is at most a quarter of the blend width outside the two shapes.
  double widest = 0;
  for (const Flesh& flesh : anatomy.flesh) widest = std::max(widest, flesh.blend);
  for (int i = 0; i < std::ssize(anatomy.flesh); ++i)
    if (anatomy.flesh[i].solid.box.grown(widest).touches(block)) nearby.flesh.push_back(i);
  if (nearby.flesh.empty()) return nearby;
  const double surface = depth_at(anatomy, nearby.flesh, centre, at).surface;
  if (surface > kSlack * radius + widest / 4) {
    nearby.flesh.clear();
    return nearby;
  }
  nearby.deep = surface < -(kSlack * radius + kSkinThickness + kMostFat);

  const auto near = [&](const Solid& solid, double reach) {
    return solid.box.grown(reach).touches(block) && solid.distance(centre) < kSlack * radius + reach;
  };
  for (int i = 0; i < std::ssize(anatomy.bones); ++i)
    if (near(anatomy.bones[i].solid, kJointGap)) nearby.bones.push_back(i);
  for (int i = 0; i < std::ssize(anatomy.inner); ++i)
    if (near(anatomy.inner[i].solid, 0)) nearby.inner.push_back(i);
  for (int i = 0; i < std::ssize(anatomy.muscles); ++i)
    if (near(anatomy.muscles[i].solid, kMuscleReach)) nearby.muscles.push_back(i);
  for (int i = 0; i < std::ssize(anatomy.nails); ++i)
    if (near(anatomy.nails[i], 0)) nearby.nails.push_back(i);
  return nearby;
}

Label bone_layer(const BonePart& bone, double distance, const glm::dvec3& p) {
  if (distance > -bone.cortex) return kCorticalBone;
  if (!bone.long_bone) return kCancellousBone;
  const glm::dvec3 along = bone.b - bone.a;
  const double t = glm::dot(p - bone.a, along) / glm::dot(along, along);
  return t > 0 && t < 1 ? kMarrow : kCancellousBone;
}

// Returns the label of a point, by the rule at the top of anatomy.h. For a point in bone, also sets `part` to 1 + the
// index of the bone part.
Label label_at(const Anatomy& anatomy, const Nearby& nearby, const glm::dvec3& p, std::vector<double>& at,
               std::uint8_t& part) {
  Depth depth{-kFar, 0};
  if (!nearby.deep) depth = depth_at(anatomy, nearby.flesh, p, at);
  if (depth.surface >= 0) return kAir;
  if (depth.surface > -kSkinThickness) {
    for (int i : nearby.nails)
      if (anatomy.nails[i].distance(p) < 0) return kNail;
    return kSkin;
  }

  double nearest = kFar, second = kFar;
  int bone = -1;
  for (int i : nearby.bones) {
    const double d = anatomy.bones[i].solid.distance(p);
    if (d < nearest) second = nearest, nearest = d, bone = i;
    else second = std::min(second, d);
  }
  if (nearest < 0) {
    part = static_cast<std::uint8_t>(bone + 1);
    return bone_layer(anatomy.bones[bone], nearest, p);
  }
  if (nearest + second < kJointGap) return kCartilage;

  for (int i : nearby.inner)
    if (anatomy.inner[i].solid.distance(p) < 0) return anatomy.inner[i].label;

  if (depth.surface > -(kSkinThickness + depth.fat)) return kFat;
  double reach = kMuscleReach;
  Label label = kFat;
  for (int i : nearby.muscles)
    if (const double d = anatomy.muscles[i].solid.distance(p); d < reach) reach = d, label = anatomy.muscles[i].label;
  return label;
}

Grid grid_around(const Anatomy& anatomy, double spacing) {
  if (!(spacing >= 0.5 && spacing <= 10))
    throw Error("a phantom cannot be made at this spacing", std::to_string(spacing) + " mm", "choose 0.5 to 10 mm");
  Box box;
  for (const Flesh& flesh : anatomy.flesh) box.add(flesh.solid.box);
  // Voxel centres are at multiples of the spacing, so that their positions do not depend on the body's extent.
  const glm::ivec3 low = glm::ivec3(glm::floor(box.low / spacing)) - kMargin;
  const glm::ivec3 high = glm::ivec3(glm::ceil(box.high / spacing)) + kMargin;
  Grid grid{high - low + 1, glm::dvec3(spacing), glm::dvec3(low) * spacing, glm::dmat3(1)};
  if (grid.voxel_count() > kMostVoxels)
    throw Error("the phantom would have " + std::to_string(grid.voxel_count()) + " voxels",
                std::to_string(spacing) + " mm", "choose a coarser spacing");
  return grid;
}

// Gives voxels new labels. All new labels are determined before any voxel is changed.
//   choose(voxel index)  returns the new label, or kLabelCount to keep the old one
template <class Choose>
void relabel(LabelVolume& volume, const Choose& choose) {
  const glm::ivec3 size = volume.grid.size;
  const std::int64_t slice = std::int64_t{size.x} * size.y;
  std::vector<std::vector<std::pair<std::int64_t, Label>>> changes(size.z);
  parallel_for(size.z, 1, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t z = std::max<std::int64_t>(begin, 1); z < std::min<std::int64_t>(end, size.z - 1); ++z)
      for (int y = 1; y + 1 < size.y; ++y)
        for (int x = 1; x + 1 < size.x; ++x) {
          const std::int64_t i = x + std::int64_t{size.x} * y + slice * z;
          if (volume.voxels[i] == kAir) continue;
          if (const Label label = choose(i); label != kLabelCount) changes[z].push_back({i, label});
        }
  });
  for (const auto& of_slice : changes)
    for (const auto& [i, label] : of_slice) volume.voxels[i] = label;
}

std::vector<std::int64_t> neighbours(const Grid& grid, int most_axes) {
  std::vector<std::int64_t> offsets;
  for (int z = -1; z <= 1; ++z)
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x)
        if (const int axes = std::abs(x) + std::abs(y) + std::abs(z); axes > 0 && axes <= most_axes)
          offsets.push_back(x + std::int64_t{grid.size.x} * (y + std::int64_t{grid.size.y} * z));
  return offsets;
}

void close_layers(LabelVolume& volume, const std::vector<std::uint8_t>& part) {
  const auto faces = neighbours(volume.grid, 1), around = neighbours(volume.grid, 3);
  const auto& voxels = volume.voxels;
  const auto touches = [&](std::int64_t i, const auto& offsets, auto test) {
    return std::any_of(offsets.begin(), offsets.end(), [&](std::int64_t offset) { return test(i + offset); });
  };
  const auto is = [&](Label label) { return [&voxels, label](std::int64_t i) { return voxels[i] == label; }; };

  // First, nail voxels that do not touch air become skin. Then other tissue that touches air or a nail becomes skin.
  relabel(volume, [&](std::int64_t i) -> Label {
    return voxels[i] == kNail && !touches(i, faces, is(kAir)) ? kSkin : kLabelCount;
  });
  relabel(volume, [&](std::int64_t i) -> Label {
    if (voxels[i] == kSkin || voxels[i] == kNail) return kLabelCount;
    return touches(i, around, is(kAir)) || touches(i, around, is(kNail)) ? kSkin : kLabelCount;
  });

  // Where two bones touch, the touching voxels of the bone that was added later become cartilage.
  const auto is_bone = [&](std::int64_t i) {
    return voxels[i] == kCorticalBone || voxels[i] == kCancellousBone || voxels[i] == kMarrow;
  };
  relabel(volume, [&](std::int64_t i) -> Label {
    if (!is_bone(i)) return kLabelCount;
    return touches(i, around, [&](std::int64_t k) { return is_bone(k) && part[k] < part[i]; }) ? kCartilage
                                                                                               : kLabelCount;
  });
  relabel(volume, [&](std::int64_t i) -> Label {
    if (voxels[i] != kMarrow && voxels[i] != kCancellousBone) return kLabelCount;
    return touches(i, faces, [&](std::int64_t k) { return !is_bone(k); }) ? kCorticalBone : kLabelCount;
  });
}
}  // namespace

int Anatomy::add_flesh(Solid solid, int parent, double blend, double fat) {
  flesh.push_back({std::move(solid), parent, blend, fat});
  return static_cast<int>(flesh.size()) - 1;
}

BonePart& Anatomy::add_bone(Solid solid, double cortex) {
  bones.push_back({std::move(solid), cortex});
  return bones.back();
}

BonePart& Anatomy::add_long_bone(Solid solid, double cortex, const glm::dvec3& a, const glm::dvec3& b) {
  bones.push_back({std::move(solid), cortex, true, a, b});
  return bones.back();
}

int Anatomy::add_rig_bone(const std::string& name, int parent, const glm::dvec3& head, const glm::dvec3& tail,
                          const JointLimits& limits) {
  armature.bones.push_back({.name = name, .parent = parent, .head = head, .tail = tail, .limits = limits});
  return static_cast<int>(armature.bones.size()) - 1;
}

JointLimits hinge(const glm::dvec3& axis, double minimum_degrees, double maximum_degrees) {
  constexpr double kRadian = std::numbers::pi / 180;
  return {.type = JointLimits::Type::Hinge,
          .axis = glm::normalize(axis),
          .minimum = minimum_degrees * kRadian,
          .maximum = maximum_degrees * kRadian};
}

JointLimits ball(double cone_degrees, double twist_minimum_degrees, double twist_maximum_degrees) {
  constexpr double kRadian = std::numbers::pi / 180;
  return {.type = JointLimits::Type::Ball,
          .cone = cone_degrees * kRadian,
          .twist_minimum = twist_minimum_degrees * kRadian,
          .twist_maximum = twist_maximum_degrees * kRadian};
}

LabelVolume voxelize(const Anatomy& anatomy, double spacing, Progress& progress) {
  LabelVolume volume{grid_around(anatomy, spacing), {}};
  const Grid& grid = volume.grid;
  volume.voxels.resize(grid.voxel_count());
  std::vector<std::uint8_t> part(grid.voxel_count(), 0);

  const glm::ivec3 blocks = (grid.size + kBlock - 1) / kBlock;
  const double radius = 0.5 * kBlock * spacing * std::numbers::sqrt3;
  // Fills one layer of blocks after another. Between layers, progress is reported and the work can be cancelled.
  for (int layer = 0; layer < blocks.z; ++layer) {
    progress.update("phantom", static_cast<double>(layer) / blocks.z);
    parallel_for(std::int64_t{blocks.x} * blocks.y, 4, [&](std::int64_t begin, std::int64_t end) {
      std::vector<double> at(anatomy.flesh.size(), kFar);
      for (std::int64_t block = begin; block < end; ++block) {
        const glm::ivec3 first = kBlock * glm::ivec3(block % blocks.x, block / blocks.x, layer);
        const glm::ivec3 last = glm::min(first + kBlock, grid.size);
        const glm::dvec3 centre = grid.origin + spacing * (glm::dvec3(first) + 0.5 * (kBlock - 1));
        const Nearby nearby = shapes_near(anatomy, centre, radius, at);
        if (nearby.flesh.empty()) continue;
        for (int z = first.z; z < last.z; ++z)
          for (int y = first.y; y < last.y; ++y)
            for (int x = first.x; x < last.x; ++x) {
              const std::int64_t i = grid.index({x, y, z});
              volume.voxels[i] = label_at(anatomy, nearby, grid.origin + spacing * glm::dvec3(x, y, z), at, part[i]);
            }
      }
    });
  }
  close_layers(volume, part);
  progress.update("phantom", 1);
  return volume;
}

}  // namespace limber::phantom
