// SPDX-License-Identifier: AGPL-3.0-or-later
// Python classes for motion capture.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "core/base/error.h"
#include "core/motion/motion_edit.h"
#include "core/motion/retarget.h"
#include "core/motion/up_axis.h"
#include "core/python/arrays.h"
#include "core/python/module.h"
#include "core/python/python_call.h"

namespace py = pybind11;

namespace limber::python {

namespace {

// A motion retargeted to a rig, together with the objects that it refers to.
struct RiggedMotion {
  std::shared_ptr<const Motion> motion;
  std::shared_ptr<const Armature> rig;
  std::shared_ptr<const Retarget> retarget;
};

std::shared_ptr<Motion> read_motion_from(const Path& path, const std::string& up) {
  if (up != "y" && up != "z" && up != "auto") throw py::value_error("up: write y, z or auto");
  Motion motion = read_bvh(path);
  warn_python(motion.warnings);
  const UpGuess guess = up_axis_of(motion);
  if (guess.axis == UpAxis::Z && up == "y")
    warn_python(
        {path.string() + " is read with y as the up axis, but " + reason_of(guess) + ": read it with up=\"z\""});
  const bool turn = up == "z" || (up == "auto" && guess.axis == UpAxis::Z);
  return std::make_shared<Motion>(turn ? y_up_from_z_up(motion) : std::move(motion));
}

RiggedMotion retargeted(const std::shared_ptr<Motion>& motion, const Armature& rig, const py::object& map,
                        const std::string& motion_rest, const std::string& rig_rest, bool root_motion) {
  RiggedMotion result{motion, std::make_shared<const Armature>(rig), nullptr};
  RetargetMap used = map.is_none() ? match_by_names(*result.motion, *result.rig)
                                   : read_retarget_map(map.cast<Path>(), *result.motion, *result.rig);
  if (!motion_rest.empty()) used.stances.source = stance_of_word(motion_rest, "motion_rest");
  if (!rig_rest.empty()) used.stances.rig = stance_of_word(rig_rest, "rig_rest");
  const RetargetSettings settings{.travel = root_motion ? Travel::Free : Travel::Locked};
  result.retarget = std::make_shared<const Retarget>(*result.motion, *result.rig, used, settings);
  return result;
}

Pose pose_at(const RiggedMotion& motion, py::ssize_t frame) {
  const py::ssize_t count = motion.motion->frame_count, at = frame < 0 ? frame + count : frame;
  if (at < 0 || at >= count)
    throw py::index_error("frame " + std::to_string(frame) + ": the motion has " + std::to_string(count) + " frames");
  return motion.retarget->at(int(at));
}

}  // namespace

void add_motions(py::module_& module) {
  py::class_<RiggedMotion>(module, "RiggedMotion", "A motion on a rig: motion[frame] is a pose.")
      .def("__len__", [](const RiggedMotion& motion) { return motion.motion->frame_count; })
      .def("__getitem__", &pose_at, py::arg("frame"), "Returns the pose of a frame, counted from 0.");

  py::class_<Motion, std::shared_ptr<Motion>>(module, "Motion", "Motion capture, as a BVH file holds it.")
      .def_property_readonly("joint_names",
                             [](const Motion& motion) {
                               std::vector<std::string> names;
                               for (const BvhJoint& joint : motion.joints) names.push_back(joint.name);
                               return names;
                             })
      .def_readonly("frame_count", &Motion::frame_count)
      .def_readonly("frame_time", &Motion::frame_time, "Seconds from frame to frame.")
      .def("__len__", [](const Motion& motion) { return motion.frame_count; })
      .def("retarget", &retargeted, py::arg("rig"), py::kw_only(), py::arg("map") = py::none(),
           py::arg("motion_rest") = "", py::arg("rig_rest") = "", py::arg("root_motion") = false,
           R"(Returns the motion on a rig.

map          a retarget map's file; None: joints and bones are matched by their names
motion_rest  treat the motion's rest pose as this pose: T, A, anatomical, or file; rig_rest: the same for the rig
root_motion  True: the body travels as the motion does)");

  module.def("read_motion", &read_motion_from, py::arg("path"), py::kw_only(), py::arg("up") = "y",
             "Reads motion capture (BVH). up: the axis that points up in the file: y, z or auto.");
}

}  // namespace limber::python
