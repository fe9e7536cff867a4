// SPDX-License-Identifier: AGPL-3.0-or-later
// A body described by shapes, before it is cut into voxels: what its flesh, bones, muscles and organs are, and the one
// rule that decides which tissue a point belongs to. The rule works at any spacing, and layers thinner than a voxel
// never drop out: after sampling, tissue that touches air becomes skin, marrow that touches anything but its own bone
// becomes cortex, and where two bones touch the later one gives way to cartilage.
//
// A point is, in this order:
//   air       outside the flesh, a union of parts that each blend only with their parent (so fingers do not fuse)
//   skin      less than the skin's thickness below the surface; nail in the marked places
//   bone      inside a bone part: cortex in its outer millimetres, below it cancellous bone or marrow
//   cartilage between two bones that come close
//   inner     the first of an ordered list of tendons, vessels, nerves, organs and cavities
//   muscle    below the fat, the nearest muscle within its reach; fat where none reaches
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
  int parent;    // place in Anatomy::flesh, -1 for the root
  double blend;  // mm, with the parent
  double fat;    // mm of fat below its skin
};

struct BonePart {
  Solid solid;
  double cortex;           // mm
  bool long_bone = false;  // marrow in the shaft a..b, cancellous bone towards its ends; otherwise all cancellous
  glm::dvec3 a{0}, b{0};
};

struct Region {
  Solid solid;
  Label label;
};

struct Anatomy {
  std::vector<Flesh> flesh;
  std::vector<BonePart> bones;  // 254 or fewer
  std::vector<Region> inner;    // first match wins
  std::vector<Region> muscles;  // nearest wins
  std::vector<Solid> nails;
  Armature armature;

  int add_flesh(Solid solid, int parent, double blend, double fat);
  BonePart& add_bone(Solid solid, double cortex);
  // A bone with a marrow core from a to b.
  BonePart& add_long_bone(Solid solid, double cortex, const glm::dvec3& a, const glm::dvec3& b);
  int add_rig_bone(const std::string& name, int parent, const glm::dvec3& head, const glm::dvec3& tail,
                   const JointLimits& limits = {});
};

JointLimits hinge(const glm::dvec3& axis, double minimum_degrees, double maximum_degrees);
JointLimits ball(double cone_degrees, double twist_minimum_degrees, double twist_maximum_degrees);

// What every phantom label is.
TissueTable phantom_tissues(const LabelVolume& volume);

// Throws Error for a spacing outside [0.5, 10] mm, or one that makes more than kMostVoxels voxels.
LabelVolume voxelize(const Anatomy& anatomy, double spacing_mm, Progress& progress);

}  // namespace limber::phantom
