// SPDX-License-Identifier: AGPL-3.0-or-later
// A study: one body at some spacings, in some poses, by some techniques. Each combination is a cell, which is one
// `limber resample`. Described in JSON; paths are relative to the description:
//   {"name"?: "Elbow", "volume": "arm.nrrd" | "phantom": "arm"|"body", "rig"?: "rig.json", "tissues"?: "t.json",
//   "bones"?: [111, 209],
//    "weights"?: "heat"|"geodesic"|"rigid", "spacings_mm"?: [2, 3, 4], "methods"?: ["lbs", "dqs", "fem", "fem-contact",
//    "fem-mass-exact"...], "poses": [{"name": "+45", "flex": ["Forearm=45"]}, {"name": "curl", "motion": "curl.bvh",
//    "frame": 12, "map"?, "up"?}, {"name": "mine", "pose": "p.json"},
//              {"name": "seated", "pose_name": "sit", "joints": ["left elbow flexion=30"]}],
//    "quality"?: "draft"|"normal"|"fine", "fit_joints"?: true, "nearest"?: true, "gates"?: {"tissue_percent": 1, ...}}
// Without spacings the volume is taken as it is, without methods the four plain ones are; a phantom brings its own rig
// and tissues.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/pose/body_poses.h"
#include "core/report/quality_gates.h"
#include "core/resample/deformation_method.h"

namespace limber {

// One way to pose that a study compares: a deformation method (resample/deformation_method.h), by finite elements with
// or without contact. With masses made exact afterwards it is a technique of its own, never silently part of the
// method.
struct Technique {
  std::string method;    // "dqs": a word of deformation_methods()
  bool contact = false;  // finite elements only
  bool mass_exact = false;

  bool is_fem() const { return method == kFiniteElements; }
  Technique plain() const { return {method, contact, false}; }
  bool operator==(const Technique&) const = default;
};
std::vector<Technique> plain_techniques();  // all that are not mass-exact
std::string technique_words();              // of those: "mix, lbs, dqs, fem, fem-contact"
std::string word_of(
    const Technique& technique);  // "fem-contact", "fem-mass-exact": in descriptions, folders and tables
std::string title_of(const Technique& technique);  // "FEM with contact", "FEM, mass-exact"
// Returns the techniques of these words. Throws Error naming `where` for a word that is none, or stands there twice.
std::vector<Technique> techniques_of(const std::vector<std::string>& words, const std::string& where);

// The colour and the mark of a technique on the page, [0, kLooks); mass-exact ones have those of the plain one, hollow.
struct TechniqueLook {
  int number = -1;  // -1: grey, for what is no technique
  bool exact = false;
};
inline constexpr int kLooks = 5;
TechniqueLook look_of(const Technique& technique);

struct StudyPose {
  std::string name;
  std::vector<std::string> flex;  // BONE=DEG; neither this nor a file: rest
  PoseRequest body;               // "pose_name" and "joints"
  Path pose, motion, map;         // files, or empty
  std::optional<int> frame;
  std::string up;
};

struct Study {
  std::string name = "Study";
  Path description;     // the file it was read from, or empty
  std::string phantom;  // "arm", "body", or empty: `volume`
  Path volume, rig, tissues;
  std::map<double, Path> ready;  // volumes that exist at a spacing; others are made from `volume`
  std::vector<double> bones;
  std::string weights = "heat", quality = "normal";
  bool fit_joints = false, nearest = false;
  std::vector<std::optional<double>> spacings;  // mm; none: as it is
  std::vector<StudyPose> poses;
  std::vector<Technique> techniques;
  QualityLimits gates;
};

// Throws Error naming the key that is wrong.
Study read_study(const Path& path);

// The paper's: an arm at 2, 3 and 4 mm, its elbow bent by 0, 45, 60 and 90 degrees more, by every technique.
//   folder  holds man-arm-2mm.mha (or others, man-arm-*mm*) and its armature; empty: the procedural arm
//   throws Error where the folder lacks either
Study paper_study(const Path& folder = {});

// As JSON, defaults included: goes into the results.
std::string to_json(const Study& study);

// "2 mm", or "as it is"
std::string spacing_text(const std::optional<double>& spacing);

}  // namespace limber
