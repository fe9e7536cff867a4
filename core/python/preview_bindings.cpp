// SPDX-License-Identifier: AGPL-3.0-or-later
// The live preview for Python: a coarse inverse map of the posed body, fast enough for every frame of a display.
#include <limits>
#include <mutex>

#include <pybind11/stl.h>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/deform/preview_map.h"
#include "core/python/arrays.h"
#include "core/python/module.h"
#include "core/resample/deformation_method.h"
#include "core/resample/pose_path.h"

namespace py = pybind11;

namespace limber::python {

namespace {

struct PosedPreview {
  std::shared_ptr<const PreviewMap> map;
  std::shared_ptr<const Body> body;

  // Returns the rest positions of posed points, world, mm; NaN for points outside the body.
  std::vector<glm::dvec3> rest_points(const std::vector<glm::dvec3>& posed) const {
    const AffineTransform voxel = voxel_from_world(map->grid), world = world_from_voxel(map->grid);
    std::vector<glm::dvec3> rest(posed.size(), glm::dvec3(std::numeric_limits<double>::quiet_NaN()));
    parallel_for(std::ssize(posed), 1024, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t p = begin; p < end; ++p)
        if (const auto at = map->rest_at(voxel * posed[p])) rest[p] = world * *at;
    });
    return rest;
  }

  std::vector<Label> labels(const std::vector<glm::dvec3>& posed) const {
    const LabelVolume& volume = body->file.volume;
    const AffineTransform voxel = voxel_from_world(map->grid);
    std::vector<Label> labels(posed.size(), 0);
    parallel_for(std::ssize(posed), 1024, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t p = begin; p < end; ++p)
        if (const auto at = map->rest_at(voxel * posed[p])) labels[p] = volume.at_or_air(glm::ivec3(glm::round(*at)));
    });
    return labels;
  }
};

class Preview {
 public:
  Preview(const Weights& weights, int step)
      : body_(weights.body),
        bones_(weights.bound->weights.bones()),
        live_(std::shared_ptr<const LabelVolume>(weights.body, &weights.body->file.volume), weights.body->tissues,
              weights.bound->tissue, weights.bound->weights, step ? step : preview_step(weights.bound->tissue)) {}

  // Locks the preview, since several Python threads may use it.
  PosedPreview posed(const Pose& pose, Blend blend) {
    const std::lock_guard lock(mutex_);
    return {live_.update(bone_motions(bones_, body_->rig, pose), blend), body_};
  }
  std::size_t bone_count() const { return body_->rig.bones.size(); }

 private:
  std::shared_ptr<const Body> body_;
  std::vector<std::string> bones_;
  std::mutex mutex_;
  LivePreview live_;
};

PosedPreview update_preview(Preview& preview, const Pose& pose, const std::string& method) {
  const DeformationMethod* found = find_method(method);
  if (!found || !found->blend)
    throw Error("this method cannot pose previews", method, "write " + method_summaries(Methods::Blends));
  if (pose.rotation.size() != preview.bone_count())
    throw Error("the pose belongs to another rig", std::to_string(pose.rotation.size()) + " bones",
                "give a pose of this body's rig");
  const py::gil_scoped_release without_lock;
  return preview.posed(pose, *found->blend);
}

py::array_t<double> rest_points_of(const PosedPreview& preview, const Doubles& points) {
  const std::vector<glm::dvec3> posed = points_from(points, "points");
  std::vector<glm::dvec3> rest;
  {
    const py::gil_scoped_release without_lock;
    rest = preview.rest_points(posed);
  }
  return array_of(rest);
}

py::array_t<Label> labels_of(const PosedPreview& preview, const Doubles& points) {
  const std::vector<glm::dvec3> posed = points_from(points, "points");
  std::vector<Label> labels;
  {
    const py::gil_scoped_release without_lock;
    labels = preview.labels(posed);
  }
  return py::array_t<Label>(py::ssize_t(labels.size()), labels.data());
}

}  // namespace

void add_previews(py::module_& module) {
  py::class_<PosedPreview>(module, "PosedPreview", "The preview of a body in one pose.")
      .def("rest_points", &rest_points_of, py::arg("points"),
           "Returns N x 3: where posed points (N x 3, LPS mm) lie at rest; NaN where there is no body.")
      .def("labels", &labels_of, py::arg("points"),
           "Returns N labels at posed points (N x 3, LPS mm); 0 where there is no body.");

  py::class_<Preview>(module, "Preview", R"(A live preview of a body: quick and coarse, for display.

step  edge of a cell in voxels: 2, 4 or 8; 0: by the size of the body)")
      .def(py::init([](const Weights& weights, int step) {
             if (step != 0 && step != 2 && step != 4 && step != 8) throw py::value_error("step: give 0, 2, 4 or 8");
             const py::gil_scoped_release without_lock;
             return std::make_unique<Preview>(weights, step);
           }),
           py::arg("weights"), py::arg("step") = 0)
      .def("pose", &update_preview, py::arg("pose"), py::arg("method") = "dqs", "Returns the preview of a pose.");
}

}  // namespace limber::python
