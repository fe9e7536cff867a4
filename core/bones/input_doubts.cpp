// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bones/input_doubts.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "core/base/parallel.h"
#include "core/bones/bone_identity.h"
#include "core/volume_io/grey_image.h"

namespace limber {

namespace {
// Limits on the share of the rig's length in tissue. If it is below kMostlyOutside, the rig is outside the body. A
// turned or mirrored rig fits better if its share is larger by at least kFitsMuchBetter. A rig that fits has 90 % of
// its length in tissue; a hand's rig, which runs along thin fingers, has less.
constexpr double kMostlyOutside = 0.5, kFitsMuchBetter = 0.3;
// If the volume shows only a part of the body (a scan of the trunk), the rig reaches beyond the volume's border. It
// still counts as fitting if at least kLeastPart of the rig's length is within the volume, kMostlyInside of this in
// tissue, and at least kLeaveInTissue of the bones that leave the volume do so through tissue.
constexpr double kLeastPart = 0.1, kMostlyInside = 0.7, kLeaveInTissue = 0.75;
constexpr int kPoints = 32;  // points examined along each rig bone
// Radius within which tissue counts as lying along a rig bone, as a share of the bone's length.
constexpr double kShaftRadius = 0.1;
// A label is doubted if at least this share of its voxels is along the middle of another bone. The share is 0 in a good
// body, and 1/6 if half of the femur is labelled as tibia.
constexpr double kMisplaced = 0.1;

struct Extent {
  glm::dvec3 low{0}, high{0};  // opposite corners of the grid; world, mm
};
Extent extent_of(const Grid& grid) {
  const AffineTransform to_world = world_from_voxel(grid);
  Extent extent{glm::dvec3(1e300), glm::dvec3(-1e300)};
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 at = to_world * (glm::dvec3(corner & 1, corner >> 1 & 1, corner >> 2) * glm::dvec3(grid.size - 1));
    extent.low = glm::min(extent.low, at);
    extent.high = glm::max(extent.high, at);
  }
  return extent;
}

// Returns the rig with `move` applied to both ends of all bones. It is used to test whether the rig's file uses other
// axes.
template <class Move>
Armature moved(Armature armature, const Move& move) {
  for (Bone& bone : armature.bones) bone.head = move(bone.head), bone.tail = move(bone.tail);
  return armature;
}

std::optional<std::string> doubt_about_grey(const LabelVolume& volume, const TissueTable& tissues) {
  const auto doubt = grey_image_doubt(volume, tissues);
  if (!doubt) return std::nullopt;
  return "this looks like a grey image, not a label volume: " + *doubt +
         "; give the label volume as input, and the image with --with";
}

// Position of a rig relative to a volume: mm of the rig's length in the volume and in tissue, and the number of times
// that a bone leaves the volume.
struct PlaceOfRig {
  double length = 0, in_volume = 0, in_tissue = 0;
  int leaves = 0, leaves_in_tissue = 0;

  double share() const { return length > 0 ? in_tissue / length : 1; }
  bool is_cut_with_body() const {
    return in_volume >= kLeastPart * length && in_tissue >= kMostlyInside * in_volume && leaves > 0 &&
           leaves_in_tissue >= kLeaveInTissue * leaves;
  }
};

PlaceOfRig place_of_rig(const LabelVolume& volume, const Armature& armature) {
  const AffineTransform from_world = voxel_from_world(volume.grid);
  PlaceOfRig place;
  for (const Bone& bone : armature.bones) {
    const double own = glm::distance(bone.head, bone.tail);
    if (!(own > 0)) continue;
    place.length += own;
    bool was_in = false, was_in_tissue = false;
    for (int k = 0; k < kPoints; ++k) {
      const glm::dvec3 at =
          glm::floor(from_world * glm::mix(bone.head, bone.tail, 0.1 + 0.8 * (k + 0.5) / kPoints) + 0.5);
      const bool is_in = glm::all(glm::greaterThanEqual(at, glm::dvec3(0))) &&
                         glm::all(glm::lessThan(at, glm::dvec3(volume.grid.size)));
      const bool is_in_tissue = is_in && volume.at(glm::ivec3(at)) != 0;
      if (is_in) place.in_volume += own / kPoints;
      if (is_in_tissue) place.in_tissue += own / kPoints;
      if (k > 0 && is_in != was_in) {
        ++place.leaves;
        place.leaves_in_tissue += is_in ? is_in_tissue : was_in_tissue;
      }
      was_in = is_in;
      was_in_tissue = is_in_tissue;
    }
  }
  return place;
}

std::optional<std::string> doubt_about_place(const LabelVolume& volume, const Armature& armature) {
  const PlaceOfRig place = place_of_rig(volume, armature);
  const double inside = place.share();
  if (inside >= kMostlyOutside || place.is_cut_with_body()) return std::nullopt;
  const Extent extent = extent_of(volume.grid);
  const glm::dvec3 twice_middle = extent.low + extent.high;
  const double turned =
      share_in_tissue(volume, moved(armature, [](const glm::dvec3& p) { return glm::dvec3(-p.x, -p.y, p.z); }));
  const double mirrored = std::max(
      share_in_tissue(volume, moved(armature, [](const glm::dvec3& p) { return glm::dvec3(-p.x, p.y, p.z); })),
      share_in_tissue(
          volume, moved(armature, [&](const glm::dvec3& p) { return glm::dvec3(twice_middle.x - p.x, p.y, p.z); })));
  char text[240];
  const char* advice = std::max(turned, mirrored) < inside + kFitsMuchBetter
                           ? "fit the rig with `limber fit-rig`, or give the rig of this body"
                       : turned >= mirrored
                           ? "negate the rig's x and y: the rig seems to be in RAS axes, and Limber's axes are LPS"
                           : "mirror the rig along x: it fits the other side of the body";
  std::snprintf(text, sizeof text, "the rig lies outside the body: only %.0f %% of its length is in tissue; %s",
                100 * inside, advice);
  return text;
}

// Returns the centre of each of the given labels that has voxels; world, mm.
std::map<Label, glm::dvec3> centres_of(const LabelVolume& volume, const std::set<Label>& labels) {
  struct Sum {
    glm::dvec3 place{0};
    std::int64_t count = 0;
  };
  constexpr std::int64_t kSlices = 64;
  std::vector<bool> is_asked(65536, false);
  for (const Label label : labels) is_asked[label] = true;
  std::vector<std::map<Label, Sum>> of_slices((volume.grid.size.z + kSlices - 1) / kSlices);
  parallel_for(volume.grid.size.z, kSlices, [&](std::int64_t begin, std::int64_t end) {
    std::vector<Sum> sums(65536);
    std::int64_t at = volume.grid.index({0, 0, static_cast<int>(begin)});
    for (auto z = static_cast<int>(begin); z < end; ++z)
      for (int y = 0; y < volume.grid.size.y; ++y)
        for (int x = 0; x < volume.grid.size.x; ++x, ++at)
          if (const Label label = volume.voxels[at]; is_asked[label])
            sums[label].place += glm::dvec3(x, y, z), ++sums[label].count;
    for (const Label label : labels) of_slices[begin / kSlices][label] = sums[label];
  });
  std::map<Label, Sum> sums;
  for (const auto& some : of_slices)
    for (const auto& [label, sum] : some) sums[label].place += sum.place, sums[label].count += sum.count;
  std::map<Label, glm::dvec3> centres;
  for (const Label label : labels)
    if (sums[label].count)
      centres[label] = world_from_voxel(volume.grid) * (sums[label].place / double(sums[label].count));
  return centres;
}

// Returns the rig bones of a region on both sides of the body, those on `side` first. Returns none if the rig does not
// distinguish the region's sides.
std::optional<std::array<std::vector<int>, 2>> both_sides(BoneRegion region, BodySide side, const Armature& armature) {
  const BodySide other = side == BodySide::Left ? BodySide::Right : BodySide::Left;
  std::array bones{bones_of_region(region, side, armature), bones_of_region(region, other, armature)};
  if (bones[0].empty() || bones[1].empty() || bones[0] == bones[1]) return std::nullopt;
  return bones;
}

// Returns a doubt if the labels whose names contain a side are mostly nearer to the rig bones of the other side.
std::optional<std::string> doubt_about_sides(const LabelVolume& volume, const TissueTable& tissues,
                                             const Armature& armature) {
  std::map<Label, AnatomicalName> sided;
  std::set<Label> labels;
  for (const Tissue& tissue : tissues.tissues) {
    if (!is_bone(tissue.kind)) continue;
    AnatomicalName name = anatomical_name(tissue.name);
    if (name.side == BodySide::Middle || name.regions.size() != 1 || *name.regions.begin() < BoneRegion::UpperArm)
      continue;
    labels.insert(tissue.label);
    sided[tissue.label] = std::move(name);
  }
  if (sided.empty()) return std::nullopt;

  const std::map<Label, glm::dvec3> centres = centres_of(volume, labels);
  int agree = 0, disagree = 0;
  std::string example;
  for (const auto& [label, centre] : centres) {
    const AnatomicalName& name = sided.at(label);
    const auto bones = both_sides(*name.regions.begin(), name.side, armature);
    if (!bones) continue;
    const auto distance = [&](int side) {
      double least = 1e300;
      for (const int b : (*bones)[side]) least = std::min(least, distance_to_bone(armature.bones[b], centre));
      return least;
    };
    if (distance(0) <= distance(1)) ++agree;
    else if (disagree++ == 0) example = tissues.find(label)->name.substr(0, 60);
  }
  if (disagree <= agree) return std::nullopt;
  return "left and right are swapped between rig and labels: \"" + example +
         "\" is on the rig's other side, like most labels; mirror the rig or correct the labels' names";
}

// Returns a doubt if, by the volume's axes (x points to the left), the rig's left bones are to the right of its right
// bones. Used only if no label's name contains a side.
std::optional<std::string> doubt_about_axes(const TissueTable& tissues, const Armature& armature) {
  for (const Tissue& tissue : tissues.tissues)
    if (is_bone(tissue.kind) && anatomical_name(tissue.name).side != BodySide::Middle) return std::nullopt;
  int agree = 0, disagree = 0;
  for (const BoneRegion region : {BoneRegion::UpperArm, BoneRegion::Forearm, BoneRegion::Thigh, BoneRegion::Shank}) {
    const auto bones = both_sides(region, BodySide::Left, armature);
    if (!bones) continue;
    const auto x = [&](int side) { return armature.bones[(*bones)[side].front()].head.x; };
    (x(0) > x(1) ? agree : disagree) += 1;
  }
  if (disagree < 2 || agree > 0) return std::nullopt;
  return "the rig's left bones are on the body's right: x points to the left in Limber's axes (LPS); mirror the rig, "
         "or negate its x and y if it is in RAS axes";
}

// Returns true if a point is beside the middle part of a rig bone, away from its joints.
bool is_along(const Bone& bone, const glm::dvec3& p) {
  const glm::dvec3 axis = bone.tail - bone.head;
  const double length = glm::length(axis);
  if (!(length > 0)) return false;
  const double share = glm::dot(p - bone.head, axis) / (length * length);
  return share > 0.25 && share < 0.75 && distance_to_bone(bone, p) < kShaftRadius * length;
}

// Returns the labels that contain a single bone of an arm or leg, each with the rig bones that it may follow.
std::map<Label, std::vector<int>> single_limb_bones(const TissueTable& tissues, const Armature& armature) {
  std::map<Label, std::vector<int>> own;
  for (const auto& [label, bones] : bones_of_labels(tissues, armature)) {
    const AnatomicalName name = anatomical_name(tissues.find(label)->name);
    if (!bones.single || name.regions.size() != 1 || bones.is_substitute) continue;
    const BoneRegion region = *name.regions.begin();
    if (region != BoneRegion::UpperArm && region != BoneRegion::Forearm && region != BoneRegion::Thigh &&
        region != BoneRegion::Shank)
      continue;
    for (const auto& side : bones.candidates) own[label].insert(own[label].end(), side.begin(), side.end());
  }
  return own;
}

// The voxels of the labels that hold a single bone of an arm or leg.
struct LabelledVoxels {
  std::map<Label, std::int64_t> count;
  // Number of a label's voxels along the middle of a rig bone that the label does not follow, by label and rig bone.
  std::map<Label, std::map<int, std::int64_t>> elsewhere;
};

LabelledVoxels count_elsewhere(const LabelVolume& volume, const std::map<Label, std::vector<int>>& own,
                               const Armature& armature) {
  std::vector<const std::vector<int>*> asked(65536, nullptr);
  for (const auto& [label, bones] : own) asked[label] = &bones;
  const AffineTransform to_world = world_from_voxel(volume.grid);
  std::vector<LabelledVoxels> of_slice(volume.grid.size.z);
  parallel_for(volume.grid.size.z, 1, [&](std::int64_t z, std::int64_t) {
    LabelledVoxels& found = of_slice[z];
    std::int64_t at = volume.grid.index({0, 0, static_cast<int>(z)});
    for (int y = 0; y < volume.grid.size.y; ++y)
      for (int x = 0; x < volume.grid.size.x; ++x, ++at) {
        const Label label = volume.voxels[at];
        if (!asked[label]) continue;
        ++found.count[label];
        const glm::dvec3 p = to_world * glm::dvec3(x, y, z);
        for (int b = 0; b < std::ssize(armature.bones); ++b)
          if (is_along(armature.bones[b], p) &&
              std::find(asked[label]->begin(), asked[label]->end(), b) == asked[label]->end()) {
            ++found.elsewhere[label][b];
            break;
          }
      }
  });
  LabelledVoxels all;
  for (const LabelledVoxels& some : of_slice) {
    for (const auto& [label, count] : some.count) all.count[label] += count;
    for (const auto& [label, bones] : some.elsewhere)
      for (const auto& [bone, count] : bones) all.elsewhere[label][bone] += count;
  }
  return all;
}

// Returns a doubt about a label that should hold a single bone but of which a good part lies along another bone.
std::optional<std::string> doubt_about_labels(const LabelVolume& volume, const TissueTable& tissues,
                                              const Armature& armature) {
  const std::map<Label, std::vector<int>> own = single_limb_bones(tissues, armature);
  if (own.empty()) return std::nullopt;
  const LabelledVoxels voxels = count_elsewhere(volume, own, armature);
  for (const auto& [label, bones] : voxels.elsewhere)
    for (const auto& [bone, count] : bones)
      if (double(count) > kMisplaced * double(voxels.count.at(label))) {
        char share[16];
        std::snprintf(share, sizeof share, "%.0f %%", 100 * double(count) / double(voxels.count.at(label)));
        return std::string(share) + " of the label \"" + tissues.find(label)->name.substr(0, 60) +
               "\" lie along the middle of " + armature.bones[bone].name +
               ", another bone: correct the labels, or say with --bone-map which bone the label follows";
      }
  return std::nullopt;
}

// Returns the limb that a region of the body belongs to: 1 arm, 2 leg, 0 trunk or head, which may occur together with
// any limb.
int limb_of(BoneRegion region) {
  using enum BoneRegion;
  return region >= UpperArm && region <= Finger ? 1 : region >= Thigh ? 2 : 0;
}
const char* name_of_limb(int limb) { return limb == 1 ? "arm" : "leg"; }

std::optional<std::string> doubt_about_limb(const TissueTable& tissues, const Armature& armature) {
  std::set<int> of_labels, of_rig;
  for (const Tissue& tissue : tissues.tissues)
    if (is_bone(tissue.kind))
      for (const BoneRegion region : anatomical_name(tissue.name).regions) of_labels.insert(limb_of(region));
  std::vector<std::string> names;
  std::vector<int> parents;
  for (const Bone& bone : armature.bones) names.push_back(bone.name), parents.push_back(bone.parent);
  for (const auto& role : joint_roles(names, parents)) {
    if (!role) continue;
    const bool leg = role->part >= BodyPart::HipLink && role->part <= BodyPart::Toes;
    const bool arm =
        (role->part >= BodyPart::UpperArm && role->part <= BodyPart::Fingers) || role->part >= BodyPart::Thumb;
    of_rig.insert(leg ? 2 : arm ? 1 : 0);
  }
  // There is a doubt only if the rig has a single kind of limb and all labels are bones of the other kind. Bones of the
  // trunk fit every rig.
  if (of_labels.size() != 1 || of_rig.size() != 1 || of_labels == of_rig || of_labels.contains(0) || of_rig.contains(0))
    return std::nullopt;
  return std::string("this is a rig of the ") + name_of_limb(*of_rig.begin()) + ", and the labels are bones of the " +
         name_of_limb(*of_labels.begin()) + "; give a rig of the same limb as the labels";
}
}  // namespace

double share_in_tissue(const LabelVolume& volume, const Armature& armature) {
  return place_of_rig(volume, armature).share();
}

std::vector<std::string> input_doubts(const LabelVolume& volume, const TissueTable& tissues, const Armature& armature) {
  std::vector<std::string> doubts;
  const auto add = [&](std::optional<std::string> doubt) {
    if (doubt) doubts.push_back(std::move(*doubt));
  };
  add(doubt_about_grey(volume, tissues));
  const auto place = doubt_about_place(volume, armature), sides = doubt_about_sides(volume, tissues, armature),
             limb = doubt_about_limb(tissues, armature);
  add(place);
  add(sides);
  add(limb);
  if (place || sides || limb) return doubts;
  add(doubt_about_axes(tissues, armature));
  add(doubt_about_labels(volume, tissues, armature));
  return doubts;
}

}  // namespace limber
