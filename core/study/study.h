// SPDX-License-Identifier: AGPL-3.0-or-later
// A study compares one body at several voxel spacings, in several poses, by several techniques (ways of posing). Each
// combination of these is a cell, computed by one run of `limber resample`. A study is described in a JSON file, in
// which paths are relative to the file's folder:
//   {"name"?: "Elbow", "volume": "arm.nrrd" | "phantom": "arm"|"body", "rig"?: "rig.json", "tissues"?: "t.json",
//    "bones"?: [111, 209], "weights"?: "heat"|"geodesic"|"rigid", "spacings_mm"?: [2, 3, 4],
//    "methods"?: ["lbs", "dqs", "fem", "fem-contact", "fem-mass-exact"...],
//    "poses": [{"name": "+45", "flex": ["Forearm=45"]},
//              {"name": "curl", "motion": "curl.bvh", "frame": 12, "map"?, "up"?},
//              {"name": "mine", "pose": "p.json"},
//              {"name": "seated", "pose_name": "sit", "joints": ["left elbow flexion=30"]}],
//    "quality"?: "draft"|"normal"|"fine", "fit_joints"?: true, "nearest"?: true, "gates"?: {"tissue_percent": 1, ...}}
// Without spacings_mm the volume keeps its own spacing; without methods the study compares lbs, dqs, fem and
// fem-contact. A phantom has its own rig and tissues.
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

// A technique: one of the ways of posing that a study compares. It is a deformation method
// (resample/deformation_method.h), and for finite elements says whether contact is simulated. A method followed by the
// correction that makes masses exact is a technique of its own, so that reports tell the two apart.
struct Technique {
  std::string method;    // "dqs": a word of deformation_methods()
  bool contact = false;  // true: contact is simulated; only for finite elements
  bool mass_exact = false;

  bool is_fem() const { return method == kFiniteElements; }
  Technique plain() const { return {method, contact, false}; }
  bool operator==(const Technique&) const = default;
};
std::vector<Technique>
plain_techniques();             // all techniques without the correction that keeps the volume of each soft tissue
std::string technique_words();  // the words of these: "mix, lbs, dqs, fem, fem-contact"
std::string word_of(
    const Technique& technique);  // "fem-contact", "fem-mass-exact": in descriptions, folders and tables
std::string title_of(const Technique& technique);  // "FEM with contact", "FEM, mass-exact"
// Returns the techniques with the given words ("lbs", "fem-contact"). Throws Error for a word that is unknown or occurs
// twice; `where` names the source of the words in the message.
std::vector<Technique> techniques_of(const std::vector<std::string>& words, const std::string& where);

// The look of a technique on the report page: `number`, [0, kLooks), selects its colour and its mark. A mass-exact
// technique (exact = true) has the look of the same method without this correction, but with a hollow mark.
struct TechniqueLook {
  int number = -1;  // -1: grey, for values that belong to no technique
  bool exact = false;
};
inline constexpr int kLooks = 5;
TechniqueLook look_of(const Technique& technique);

struct StudyPose {
  std::string name;
  std::vector<std::string> flex;  // requests BONE=DEGREES; if `flex`, `body` and all files are empty: the rest pose
  PoseRequest body;               // from the keys "pose_name" and "joints"
  Path pose, motion, map;         // pose file, motion file and retarget map; empty: no such file
  std::optional<int> frame;
  std::string up;
};

struct Study {
  std::string name = "Study";
  Path description;     // the file that the study was read from; empty: none
  std::string phantom;  // "arm", "body", or empty for a study of `volume`
  Path volume, rig, tissues;
  std::map<double, Path> ready;  // volume files at some spacings (mm); at other spacings `volume` is resampled
  std::vector<double> bones;
  std::string weights = "heat", quality = "normal";
  bool fit_joints = false, nearest = false;
  std::vector<std::optional<double>> spacings;  // voxel spacings, mm; an empty entry: the volume's own spacing
  std::vector<StudyPose> poses;
  std::vector<Technique> techniques;
  QualityLimits gates;
};

// Reads the description of a study from a JSON file. Throws Error for a wrong value, with its key in the message.
Study read_study(const Path& path);

// Returns the built-in study of elbow flexion: an arm at 2, 3 and 4 mm whose elbow is bent by 0, 45, 60 and 90 degrees
// more than at rest, by the techniques lbs, dqs, fem and fem-contact. Throws Error if the folder lacks the volume or
// the armature.
//   folder  contains man-arm-2mm.mha (or other man-arm-*mm volumes) and its armature; empty: uses the procedural arm
Study paper_study(const Path& folder = {});

// Returns the study as JSON for the file of results, with the values of all keys that were left at their defaults.
std::string to_json(const Study& study);

// Returns "2 mm", or "as it is" for the volume's own spacing.
std::string spacing_text(const std::optional<double>& spacing);

}  // namespace limber
