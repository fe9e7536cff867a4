// SPDX-License-Identifier: AGPL-3.0-or-later
// Python classes for rigs and poses.
#include <algorithm>
#include <map>
#include <optional>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "core/autorig/place_in_tissue.h"
#include "core/base/error.h"
#include "core/pose/body_poses.h"
#include "core/pose/clinical_angles.h"
#include "core/pose/pose_io.h"
#include "core/python/arrays.h"
#include "core/python/module.h"
#include "core/python/python_call.h"
#include "core/rig/pose.h"
#include "core/rig_io/rig_io.h"
#include "core/rig_io/rig_templates.h"

namespace py = pybind11;

namespace limber::python {

namespace {

Armature read_rig(const Path& path) {
  ArmatureFile file = read_armature_file(path);
  warn_python(file.warnings);
  return std::move(file.armature);
}

Armature rig_from(const std::vector<std::string>& names, const std::vector<std::optional<std::string>>& parents,
                  const Doubles& heads, const Doubles& tails) {
  const std::vector<glm::dvec3> head = points_from(heads, "heads"), tail = points_from(tails, "tails");
  if (parents.size() != names.size() || head.size() != names.size() || tail.size() != names.size())
    throw py::value_error("names, parents, heads and tails: give lists of equal length");
  std::vector<Bone> bones(names.size());
  for (std::size_t b = 0; b < bones.size(); ++b) {
    bones[b].name = names[b];
    bones[b].head = head[b];
    bones[b].tail = tail[b];
    if (!parents[b]) continue;
    const auto parent = std::find(names.begin(), names.end(), *parents[b]);
    if (parent == names.end()) throw Error("there is no such bone", *parents[b], "name one of the rig's bones");
    bones[b].parent = int(parent - names.begin());
  }
  Armature rig = parents_first(std::move(bones), "rig");
  check_armature(rig, "rig");
  return rig;
}

std::vector<glm::dvec3> ends_of(const Armature& rig, glm::dvec3 Bone::*end) {
  std::vector<glm::dvec3> ends;
  for (const Bone& bone : rig.bones) ends.push_back(bone.*end);
  return ends;
}

std::vector<std::string> names_of(const Armature& rig) {
  std::vector<std::string> names;
  for (const Bone& bone : rig.bones) names.push_back(bone.name);
  return names;
}

std::vector<std::optional<std::string>> parents_of(const Armature& rig) {
  std::vector<std::optional<std::string>> parents;
  for (const Bone& bone : rig.bones)
    parents.push_back(bone.parent < 0 ? std::nullopt : std::optional(rig.bones[bone.parent].name));
  return parents;
}

glm::dquat rotation_from(const py::handle& value, const std::string& bone) {
  const std::string where = "rotations[" + bone + "]";
  if (py::isinstance<py::tuple>(value) && py::len(value) == 2) {
    const auto pair = value.cast<py::tuple>();
    const glm::dvec3 axis = vector_from(pair[0].cast<Doubles>(), where);
    if (glm::length(axis) == 0) throw py::value_error(where + ": the axis has no length");
    return glm::angleAxis(glm::radians(pair[1].cast<double>()), glm::normalize(axis));
  }
  const auto wxyz = value.cast<std::vector<double>>();
  if (wxyz.size() != 4) throw py::value_error(where + ": give (axis, degrees) or a quaternion (w, x, y, z)");
  const glm::dquat q(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  if (!(glm::length(q) > 0)) throw py::value_error(where + ": the quaternion has no length");
  return glm::normalize(q);
}

// Returns the request "left hip flexion=90" for ("left hip flexion", 90).
std::string joint_request(const std::string& motion, double degrees) {
  char number[40];
  std::snprintf(number, sizeof number, "%.17g", degrees);
  return motion + "=" + number;
}

Pose pose_from(const Armature& rig, const std::string& name, const std::map<std::string, double>& joints,
               const std::map<std::string, double>& flexed, const py::dict& rotations,
               const py::object& root_translation) {
  Pose pose = rest_pose(rig);
  for (const auto& [bone, value] : rotations)
    pose.rotation[require_bone(rig, bone.cast<std::string>())] = rotation_from(value, bone.cast<std::string>());
  PoseRequest request{name, {}};
  for (const auto& [motion, degrees] : joints) request.joints.push_back(joint_request(motion, degrees));
  std::vector<std::string> warnings;
  if (!request.empty()) pose = with_request(rig, pose, request, warnings);
  for (const auto& [bone, degrees] : flexed) flex(pose, rig, require_bone(rig, bone), degrees);
  if (!root_translation.is_none())
    pose.root_translation = vector_from(root_translation.cast<Doubles>(), "root_translation");
  warn_python(warnings);
  return pose;
}

void require_pose_of(const Armature& rig, const Pose& pose) {
  if (pose.rotation.size() != rig.bones.size())
    throw Error("the pose belongs to another rig", std::to_string(pose.rotation.size()) + " bones",
                "give a pose of this rig, which has " + std::to_string(rig.bones.size()));
}

// Returns the clinical angles of a pose: {"left hip flexion": 90.0, ...}.
std::map<std::string, double> angles_of_pose(const Armature& rig, const Pose& pose) {
  require_pose_of(rig, pose);
  std::map<std::string, double> angles;
  for (const auto& [joint, motions] : clinical_angles(rig, body_frames(rig), pose))
    for (std::size_t i = 0; i < motions.size(); ++i)
      if (motions[i]) angles[name_of(joint) + " " + std::string(motion_name(joint.joint, i))] = *motions[i];
  return angles;
}

py::array_t<double> rotations_of(const Pose& pose) {
  py::array_t<double> array({py::ssize_t(pose.rotation.size()), py::ssize_t(4)});
  for (std::size_t b = 0; b < pose.rotation.size(); ++b) {
    const glm::dquat& q = pose.rotation[b];
    const double wxyz[4] = {q.w, q.x, q.y, q.z};
    for (int i = 0; i < 4; ++i) array.mutable_at(b, i) = wxyz[i];
  }
  return array;
}

Pose pose_of_arrays(const Doubles& rotations, const py::object& root_translation) {
  if (rotations.ndim() != 2 || rotations.shape(1) != 4)
    throw py::value_error("rotations: give an array of N x 4 numbers, w, x, y, z for each bone");
  Pose pose;
  for (py::ssize_t b = 0; b < rotations.shape(0); ++b) {
    const glm::dquat q(rotations.at(b, 0), rotations.at(b, 1), rotations.at(b, 2), rotations.at(b, 3));
    if (!(glm::length(q) > 0 && std::isfinite(glm::length(q))))
      throw py::value_error("rotations: a quaternion has no length or is not finite");
    pose.rotation.push_back(glm::normalize(q));
  }
  if (!root_translation.is_none())
    pose.root_translation = vector_from(root_translation.cast<Doubles>(), "root_translation");
  return pose;
}

// Returns the fitted rig, the possible error of each joint, and warnings.
py::tuple fit_rig(const Volume& volume, const std::string& name, const py::object& progress) {
  const LabelVolume& labels = volume.file->volume;
  const AutoFit fitted = call_with_result(progress, [&](Progress& shown) {
    const Armature rig = rig_template(name == "auto" ? suggest_template(labels, shown) : name);
    return fitted_or_placed(labels, volume.file->tissues, rig, shown);
  });
  warn_python(fitted.warnings);
  py::dict errors;
  for (std::size_t b = 0; b < fitted.joints.size(); ++b)
    errors[py::str(fitted.armature.bones[b].name)] = fitted.joints[b].error;
  return py::make_tuple(fitted.armature, errors);
}

}  // namespace

void add_rigs(py::module_& module) {
  py::class_<Pose>(module, "Pose", R"(A pose of a rig: each bone turns about its head, relative to rest and its parent.

rotations         N x 4: a unit quaternion (w, x, y, z) for each bone, in the world axes of the rest pose
root_translation  mm, of every root bone)")
      .def(py::init(&pose_of_arrays), py::arg("rotations"), py::arg("root_translation") = py::none())
      .def_property_readonly("rotations", &rotations_of, "N x 4: w, x, y, z for each bone")
      .def_property_readonly(
          "root_translation", [](const Pose& pose) { return array_of(pose.root_translation); }, "mm")
      .def("__eq__", [](const Pose& a, const Pose& b) { return a == b; })
      .def("__len__", [](const Pose& pose) { return pose.rotation.size(); });

  py::class_<Armature>(module, "Rig", R"(A rig: bones with head and tail, in LPS mm. Parents come before children.

names    of the bones; parents: the name of each bone's parent, None for a root; heads, tails: N x 3, LPS mm)")
      .def(py::init(&rig_from), py::arg("names"), py::arg("parents"), py::arg("heads"), py::arg("tails"))
      .def_property_readonly("names", &names_of)
      .def_property_readonly("parents", &parents_of)
      .def_property_readonly(
          "heads", [](const Armature& rig) { return array_of(ends_of(rig, &Bone::head)); }, "N x 3, LPS mm")
      .def_property_readonly(
          "tails", [](const Armature& rig) { return array_of(ends_of(rig, &Bone::tail)); }, "N x 3, LPS mm")
      .def("__len__", [](const Armature& rig) { return rig.bones.size(); })
      .def(
          "index", [](const Armature& rig, const std::string& name) { return require_bone(rig, name); },
          py::arg("name"), "Returns the index of a bone.")
      .def("rest_pose", &rest_pose, "Returns the pose in which nothing moves.")
      .def("pose", &pose_from, py::arg("name") = "", py::kw_only(), py::arg("joints") = std::map<std::string, double>(),
           py::arg("flex") = std::map<std::string, double>(), py::arg("rotations") = py::dict(),
           py::arg("root_translation") = py::none(), R"(Returns a pose.

name       a pose of any body: sit, walk, squat, arms up ... (limber.pose_names)
joints     degrees from the anatomical position: {"left elbow flexion": 90, "knees flexion": 60}
flex       degrees about the hinges of bones, positive bends further: {"Forearm": 60}
rotations  of single bones, in the world axes at rest: {"Hand": ((1, 0, 0), 30)} or {"Hand": (w, x, y, z)})")
      .def("angles", &angles_of_pose, py::arg("pose"),
           R"(Returns the clinical angles of a pose: {"left elbow flexion": 90.0, ...}.

They are in degrees from the anatomical position. pose(joints=angles) gives the pose again, except for turns that no
angle names. Joints are known by the bones' names.)")
      .def(
          "read_pose", [](const Armature& rig, const Path& path) { return read_pose(path, rig); }, py::arg("path"),
          "Reads a pose (JSON) of this rig.")
      .def(
          "save_pose",
          [](const Armature& rig, const Pose& pose, const Path& path) {
            require_pose_of(rig, pose);
            write_pose(pose, rig, path);
          },
          py::arg("pose"), py::arg("path"), "Writes a pose of this rig as JSON.")
      .def(
          "transforms",
          [](const Armature& rig, const Pose& pose) {
            require_pose_of(rig, pose);
            return array_of(posed_from_rest(rig, pose));
          },
          py::arg("pose"), "Returns N x 4 x 4: for each bone, the motion from rest to the pose, LPS mm.")
      .def("save", &write_armature, py::arg("path"),
           "Writes the rig: .json keeps everything, .vtk and .bvh only its bones.")
      .def("__eq__", [](const Armature& a, const Armature& b) { return a == b; })
      .def("__repr__", [](const Armature& rig) { return "<Rig of " + std::to_string(rig.bones.size()) + " bones>"; });

  module.def("read_rig", &read_rig, py::arg("path"), "Reads a rig: Limber JSON, Bender .vtk or .arm, BVH or glTF.");
  module.def("fit_rig", &fit_rig, py::arg("volume"), py::arg("template") = "auto", py::kw_only(),
             py::arg("progress") = py::none(), R"(Fits a rig to a volume and returns (rig, errors).

template  arm, hand, leg, adult, child, quadruped, or auto
errors    {bone: mm by which the joint at its head may be off})");
  py::list names;
  for (const BodyPose& pose : body_poses()) names.append(py::str(std::string(pose.name)));
  module.attr("pose_names") = py::tuple(names);
}

}  // namespace limber::python
