// SPDX-License-Identifier: AGPL-3.0-or-later
// Describes a body by shapes (flesh, bones, muscles and organs) and by a rule that decides which tissue a point belongs
// to. voxelize() samples the body at any spacing. Layers thinner than a voxel are never lost: after sampling, tissue
// that touches air becomes skin, marrow or cancellous bone that touches other tissue becomes cortex, and where two
// bones touch, voxels of the bone later in the list become cartilage.
//
// A point gets the first tissue of this list that applies:
//   air       outside the flesh, which is a union of parts that blend with their parent only (so fingers do not fuse)
//   skin      less than the skin's thickness below the surface; nail inside the solids of the nails
//   bone      inside a bone part: cortex in its outer millimetres, below it cancellous bone or marrow
//   cartilage between two bones that come close to each other
//   inner     inside a tendon, vessel, nerve, organ or cavity; if inside several, the first one in Anatomy::inner
//   muscle    below the fat: the nearest muscle, or fat if every muscle is more than 7 mm away
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/phantom/shapes.h"
#include "core/rig/armature.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"

namespace limber::phantom {

enum PhantomLabel : Label {
  kAir,
  kSkin,
  kNail,
  kFat,
  kVisceralFat,
  kCorticalBone,
  kCancellousBone,
  kMarrow,
  kCartilage,
  kDisc,
  kTendon,
  kLigament,
  kDeltoid,
  kBiceps,
  kTriceps,
  kBrachialis,
  kBrachioradialis,
  kForearmFlexors,
  kForearmExtensors,
  kHandMuscles,
  kTrapezius,
  kPectoralis,
  kLatissimus,
  kShoulderMuscles,
  kBackMuscles,
  kAbdominalMuscles,
  kNeckMuscles,
  kFaceMuscles,
  kIntercostals,
  kDiaphragm,
  kIliopsoas,
  kGluteals,
  kQuadriceps,
  kHamstrings,
  kAdductors,
  kCalf,
  kShinMuscles,
  kFootMuscles,
  kArtery,
  kVein,
  kNerve,
  kSpinalCord,
  kBrain,
  kEye,
  kTongue,
  kTrachea,
  kOesophagus,
  kLung,
  kHeart,
  kLiver,
  kStomach,
  kSpleen,
  kKidney,
  kIntestine,
  kColon,
  kBladder,
  kLabelCount
};

struct Flesh {
  Solid solid;
  int parent;    // index in Anatomy::flesh, -1 for the root
  double blend;  // width of the smooth union with the parent, mm
  double fat;    // thickness of the fat layer below the skin, mm
};

struct BonePart {
  Solid solid;
  double cortex;  // thickness of the cortical bone, mm
  // true: below the cortex lies marrow between the points a and b, and cancellous bone beyond them; false: only
  // cancellous bone
  bool long_bone = false;
  glm::dvec3 a{0}, b{0};
};

struct Region {
  Solid solid;
  Label label;
};

struct Anatomy {
  std::vector<Flesh> flesh;
  std::vector<BonePart> bones;  // at most 254 of them
  std::vector<Region> inner;    // tendons, vessels, organs ...; a point belongs to the first one that contains it
  std::vector<Region> muscles;  // a point belongs to the nearest muscle
  std::vector<Solid> nails;
  Armature armature;

  int add_flesh(Solid solid, int parent, double blend, double fat);
  BonePart& add_bone(Solid solid, double cortex);
  // Adds a long bone, whose marrow reaches from a to b; its ends are cancellous bone.
  BonePart& add_long_bone(Solid solid, double cortex, const glm::dvec3& a, const glm::dvec3& b);
  int add_rig_bone(const std::string& name, int parent, const glm::dvec3& head, const glm::dvec3& tail,
                   const JointLimits& limits = {});
};

JointLimits hinge(const glm::dvec3& axis, double minimum_degrees, double maximum_degrees);
JointLimits ball(double cone_degrees, double twist_minimum_degrees, double twist_maximum_degrees);

// Returns the tissues of the phantom labels that occur in a volume.
TissueTable phantom_tissues(const LabelVolume& volume);

// Samples the anatomy on a grid. Throws Error for a spacing outside [0.5, 10] mm, and for one that makes more than 2^30
// voxels.
LabelVolume voxelize(const Anatomy& anatomy, double spacing_mm, Progress& progress);

}  // namespace limber::phantom
