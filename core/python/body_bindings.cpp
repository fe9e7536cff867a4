// SPDX-License-Identifier: AGPL-3.0-or-later
// Python classes for bodies, weights and posed bodies.
#include <algorithm>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "core/base/error.h"
#include "core/body/pose_body.h"
#include "core/export/exporter.h"
#include "core/phantom/phantom.h"
#include "core/python/arrays.h"
#include "core/python/module.h"
#include "core/python/python_call.h"
#include "core/resample/posed_points.h"
#include "core/seams/seams_io.h"
#include "core/skin/weights_io.h"
#include "core/tissue/dielectric.h"

namespace py = pybind11;

namespace limber::python {

namespace {

// The result of posing a body once. Its volume and its fields share memory with Python's arrays.
struct PosedVolume {
  std::shared_ptr<Posed> posed;
  Volume volume;
  Armature rig;
  Pose pose;
  std::string report;  // report on the posed volume, JSON; empty: the volume was not measured
  std::vector<std::string> warnings;
  double reached = 1;
};

std::shared_ptr<Body> body_from(const Volume& volume, const Armature& rig, const TissueTable* tissues,
                                const std::vector<double>& bones, const BoneMap& map) {
  std::shared_ptr<Body> body;
  {
    const py::gil_scoped_release without_lock;
    body = std::make_shared<Body>(make_body(shared_copy(volume), tissues, rig, bones, map, "the volume"));
  }
  warn_python(body->warnings);
  return body;
}

SeamChoice seams_from(const py::object& seams, const LabelVolume& volume) {
  if (seams.is_none()) return std::nullopt;
  if (py::isinstance<py::str>(seams) && seams.cast<std::string>() == "none") return std::shared_ptr<const Seams>();
  return std::make_shared<const Seams>(read_seams(seams.cast<Path>(), volume, no_progress()));
}

Weights bound_weights(const std::shared_ptr<Body>& body, BoundBody bound) {
  warn_python(bound.warnings);
  return {body, std::make_shared<BoundBody>(std::move(bound))};
}

Weights weights_of(const std::shared_ptr<Body>& body, const std::string& method, const py::object& seams,
                   const py::object& progress) {
  const Binding binding = require_binding(method, "method " + method);
  const SeamChoice choice = seams_from(seams, body->file.volume);
  return bound_weights(
      body, call_with_result(progress, [&](Progress& shown) { return bind_body(*body, binding, choice, shown); }));
}

Weights read_weights_of(const std::shared_ptr<Body>& body, const Path& path, const py::object& seams,
                        const py::object& progress) {
  const SeamChoice choice = seams_from(seams, body->file.volume);
  return bound_weights(
      body, call_with_result(progress, [&](Progress& shown) { return read_bound_body(*body, path, choice, shown); }));
}

// Returns a copy of the weights with other influences.
//   bones, weights  N x 4, in the order of Weights.voxels
Weights with_influences(const Weights& from, const py::array_t<int, py::array::c_style | py::array::forcecast>& bones,
                        const Doubles& weights) {
  const TissueVoxels& tissue = from.bound->tissue;
  const int bone_count = int(from.bound->weights.bones().size());
  for (const py::array& array : {py::array(bones), py::array(weights)})
    if (array.ndim() != 2 || array.shape(0) != tissue.size() || array.shape(1) != 4)
      throw py::value_error("bones, weights: give arrays of " + std::to_string(tissue.size()) + " x 4 numbers");
  auto bound = std::make_shared<BoundBody>(*from.bound);
  std::vector<Influence> influences;
  for (std::size_t b = 0; b < tissue.bricks().size(); ++b) {
    const TissueVoxels::Brick& brick = tissue.bricks()[b];
    influences.clear();
    for (std::int64_t v = brick.first; v < brick.first + brick.count(); ++v) {
      std::vector<std::pair<int, double>> parts;
      for (int i = 0; i < 4; ++i) {
        const double weight = weights.at(v, i);
        if (!(weight >= 0 && std::isfinite(weight))) throw py::value_error("weights: give numbers of 0 or more");
        if (weight == 0) continue;
        if (bones.at(v, i) < 0 || bones.at(v, i) >= bone_count)
          throw py::value_error("bones: " + std::to_string(bones.at(v, i)) + " is not a bone of the weights");
        parts.emplace_back(bones.at(v, i), weight);
      }
      if (parts.empty()) throw py::value_error("weights: voxel " + std::to_string(v) + " follows no bone");
      influences.push_back(quantize(parts));
    }
    bound->weights.set_chunk(std::int64_t(b), influences);
  }
  bound->is_from_file = true;
  return {from.body, bound};
}

py::tuple influences_of(const Weights& weights) {
  const SkinWeights& skin = weights.bound->weights;
  py::array_t<std::uint16_t> bones({py::ssize_t(skin.size()), py::ssize_t(4)}), parts = bones.attr("copy")();
  std::uint16_t *bone = bones.mutable_data(), *part = parts.mutable_data();
  for (std::int64_t chunk = 0; chunk < skin.chunk_count(); ++chunk)
    for (const Influence influence : skin.chunk(chunk))
      for (int i = 0; i < 4; ++i) {
        *bone++ = influence.bone[i];
        *part++ = influence.weight[i];
      }
  return py::make_tuple(bones, parts);
}

py::array_t<int> voxels_of(const Weights& weights) {
  py::array_t<int> voxels({py::ssize_t(weights.bound->tissue.size()), py::ssize_t(3)});
  int* data = voxels.mutable_data();
  weights.bound->tissue.for_each([&](std::int64_t at, const glm::ivec3& voxel) {
    for (int i = 0; i < 3; ++i) data[3 * at + i] = voxel[i];
  });
  return voxels;
}

// Returns the weight of one bone at every voxel, as a float array.
py::array weight_volume(const Weights& weights, const std::string& bone) {
  const std::vector<std::string>& names = weights.bound->weights.bones();
  const auto found = std::find(names.begin(), names.end(), bone);
  if (found == names.end()) throw Error("there is no such bone", bone, "name one of Weights.bones");
  const int index = int(found - names.begin());
  const Grid& grid = weights.body->file.volume.grid;
  auto values = std::make_shared<ZeroedVector<float>>(std::size_t(grid.voxel_count()));
  const SkinWeights& skin = weights.bound->weights;
  const TissueVoxels& tissue = weights.bound->tissue;
  std::vector<Influence> influences;
  for (std::size_t b = 0; b < tissue.bricks().size(); ++b) {
    influences = skin.chunk(std::int64_t(b));
    tissue.for_each(std::int64_t(b), std::int64_t(b) + 1, [&](std::int64_t at, const glm::ivec3& voxel) {
      (*values)[std::size_t(grid.index(voxel))] = float(influences[at - tissue.bricks()[b].first].of(index));
    });
  }
  return voxel_array(grid, values->data(), values);
}

struct ResampleOptions {
  std::string method, glide, quality, mesher;
  bool contact, nearest, mass_exact, fit_joints, report, displacement, jacobian, overlap;
  std::optional<double> spacing;
};

// Throws Error if options of finite elements are given for another method, as the command line does.
void check_options(const ResampleOptions& options) {
  if (!find_method(options.method))
    throw Error("there is no such method", options.method, "write " + method_summaries(Methods::All));
  for (const auto& [word, known, name] :
       {std::tuple{options.quality, std::vector<std::string>{"", "draft", "normal", "fine"}, "quality"},
        std::tuple{options.mesher, std::vector<std::string>{"", "lattice", "tetgen"}, "mesher"}})
    if (std::find(known.begin(), known.end(), word) == known.end())
      throw Error(std::string("there is no such ") + name, word, "write " + known[1] + " or " + known[2]);
  if (options.mass_exact && options.nearest)
    throw Error("mass_exact needs interpolated labels, which nearest does not compute", "mass_exact",
                "leave out mass_exact or nearest");
  if (options.method == kFiniteElements) return;
  if (options.contact || !options.quality.empty() || !options.mesher.empty())
    throw Error("contact, quality and mesher need finite elements", "method " + options.method, "use method=\"fem\"");
}

std::shared_ptr<GreyVolume> grey_from(const py::object& grey, const Grid& grid) {
  if (grey.is_none()) return nullptr;
  const auto values = py::array_t<float, py::array::f_style | py::array::forcecast>::ensure(grey);
  if (!values || values.ndim() != 3 || values.shape(0) != grid.size.x || values.shape(1) != grid.size.y ||
      values.shape(2) != grid.size.z)
    throw py::value_error("grey: give an array of the volume's shape");
  return std::make_shared<GreyVolume>(GreyVolume{grid, {values.data(), values.data() + values.size()}, {}, {}});
}

PosedVolume result_of(const Body& body, const PosingSettings& settings, bool with_report, BodyInPose& in_pose) {
  PosedVolume result;
  result.reached = in_pose.posed.report.solve ? in_pose.posed.report.solve->reached : 1;
  result.rig = in_pose.rig;
  result.pose = in_pose.posed.shape ? in_pose.posed.shape->pose : in_pose.pose;
  if (with_report) {
    measure_posed_body(body, settings, in_pose);
    result.report = to_json(in_pose.report);
  }
  result.warnings = in_pose.report.warnings;
  result.posed = std::make_shared<Posed>(std::move(in_pose.posed));
  VolumeFile file{std::move(result.posed->volume), body.tissues, body.file.type, {}};
  result.volume = volume_of(std::move(file));
  return result;
}

py::object resample_body(const Weights& weights, const py::object& poses, const ResampleOptions& options,
                         const py::object& grey, const py::object& progress) {
  check_options(options);
  const bool is_one = py::isinstance<Pose>(poses);
  std::vector<Pose> asked = is_one ? std::vector<Pose>{poses.cast<Pose>()} : std::vector<Pose>{};
  if (!is_one)
    for (const py::handle pose : poses) asked.push_back(pose.cast<Pose>());
  if (asked.empty()) return py::list();
  for (const Pose& pose : asked)
    if (pose.rotation.size() != weights.body->rig.bones.size())
      throw Error("the pose belongs to another rig", std::to_string(pose.rotation.size()) + " bones",
                  "give a pose of this body's rig");
  if (options.fit_joints && asked.size() > 1)
    throw Error("joints are fitted to one pose, not to a sequence", "fit_joints", "give one pose");
  const std::shared_ptr<GreyVolume> carried = grey_from(grey, weights.body->file.volume.grid);
  const PosingSettings settings{.method = options.method,
                                .contact = options.contact,
                                .quality = options.quality,
                                .mesher = options.mesher,
                                .glide = options.glide,
                                .fit_joints = options.fit_joints,
                                .resample = {.nearest = options.nearest,
                                             .mass_exact = options.mass_exact,
                                             .spacing = options.spacing,
                                             .displacement = options.displacement,
                                             .tiled_displacement = options.report && !options.displacement,
                                             .jacobian = options.jacobian,
                                             .overlap = options.overlap,
                                             .grey = carried.get()}};
  std::vector<PosedVolume> results;
  call_long(progress, [&](Progress& shown) {
    // Copies the bound body, since fitting joints changes it and other threads may use it.
    BoundBody bound = *weights.bound;
    PosingEvents events;
    events.on_step = [&](const SolveStep& step) { shown.update("solving", step.reached); };
    pose_body(
        *weights.body, bound, asked, settings, {}, events,
        [&](BodyInPose& in_pose) { results.push_back(result_of(*weights.body, settings, options.report, in_pose)); },
        shown);
  });
  py::list list;
  for (PosedVolume& result : results) {
    warn_python(result.warnings);
    list.append(py::cast(std::move(result)));
  }
  return is_one ? py::object(list[0]) : py::object(list);
}

template <class T>
py::object field_of(const PosedVolume& result, const ZeroedVector<T>& values) {
  if (values.empty()) return py::none();
  return voxel_array(result.volume.file->volume.grid, values.data(), result.posed);
}

py::object displacement_of(const PosedVolume& result) {
  const ZeroedVector<glm::vec3>& field = result.posed->displacement;
  if (field.empty()) return py::none();
  const glm::ivec3 size = result.volume.file->volume.grid.size;
  auto* held = new std::shared_ptr<const Posed>(result.posed);
  const py::capsule keeper(held, [](void* kept) { delete static_cast<std::shared_ptr<const Posed>*>(kept); });
  const auto step = py::ssize_t(sizeof(glm::vec3));
  return py::array_t<float>({py::ssize_t(size.x), py::ssize_t(size.y), py::ssize_t(size.z), py::ssize_t(3)},
                            {step, step * size.x, step * size.x * size.y, py::ssize_t(sizeof(float))}, &field[0].x,
                            keeper);
}

py::object report_of(const PosedVolume& result) {
  if (result.report.empty()) return py::none();
  return py::module_::import("json").attr("loads")(result.report);
}

py::object grey_of(const PosedVolume& result) {
  if (result.posed->grey.voxels.empty()) return py::none();
  return voxel_array(result.posed->grey.grid, result.posed->grey.voxels.data(), result.posed);
}

py::array_t<double> move_points(const Weights& weights, const Doubles& points, const Pose& pose,
                                const std::string& method) {
  const DeformationMethod* found = find_method(method);
  if (!found || !found->blend)
    throw Error("this method cannot move points", method, "write " + method_summaries(Methods::Blends));
  const std::vector<glm::dvec3> rest = points_from(points, "points");
  std::vector<glm::dvec3> posed;
  {
    const py::gil_scoped_release without_lock;
    posed = posed_points(weights.body->file.volume, weights.bound->tissue, weights.body->tissues,
                         weights.bound->weights, weights.body->rig, pose, *found->blend, nullptr, rest);
  }
  return array_of(posed);
}

void save_weights(const Weights& weights, const Path& path) {
  const py::gil_scoped_release without_lock;
  check_weights_writable(path);
  write_weights(weights.bound->weights, weights.body->file.volume, weights.bound->tissue, path,
                SeamsOfWeights::OfTissue);
}

void export_volume(const Volume& volume, const Path& path, std::optional<double> frequency,
                   const py::object& progress) {
  const Exporter* exporter = exporter_for(path);
  if (!exporter || !exporter->takes_voxels)
    throw Error("bodies cannot be exported with this extension", path.string(), "use one of " + exporter_endings());
  std::vector<TissueMaterial> materials;
  if (exporter->needs_frequency) {
    if (!frequency)
      throw Error("permittivity and conductivity depend on the frequency", path.string(), "add frequency=900e6, in Hz");
    TissueMaterials found = tissue_materials(volume.file->tissues, read_dielectric_table({}), *frequency);
    std::string unknown;
    for (const std::string& name : found.unmatched) unknown += (unknown.empty() ? "" : ", ") + name;
    if (!unknown.empty())
      throw Error("no dielectric properties are known for: " + unknown, path.string(),
                  "give these tissues other names or kinds, or merge their labels");
    materials = std::move(found.materials);
  }
  std::vector<std::string> warnings;
  if (const std::string line = stand_ins_text(materials); !line.empty()) warnings.push_back(line);
  call_long(progress, [&](Progress& shown) {
    write_export(
        *exporter,
        {volume.file->volume, volume.file->tissues, materials, frequency.value_or(0), nullptr, shown, warnings}, path);
  });
  warn_python(warnings);
}

py::tuple make_phantom(const std::string& name, std::optional<double> spacing) {
  if (name != "arm" && name != "body") throw Error("there is no such phantom", name, "write arm or body");
  const double mm = spacing.value_or(name == "arm" ? 2 : 4);
  Phantom phantom = call_with_result(py::none(), [&](Progress& shown) {
    return name == "arm" ? make_arm_phantom(mm, shown) : make_body_phantom(mm, shown);
  });
  VolumeFile file{std::move(phantom.volume), std::move(phantom.tissues), {"NRRD", "uint8", true}, {}};
  return py::make_tuple(volume_of(std::move(file)), std::move(phantom.armature),
                        std::make_shared<Motion>(std::move(phantom.motion)));
}

}  // namespace

void add_bodies(py::module_& module) {
  py::class_<Body, std::shared_ptr<Body>>(module, "Body", R"(A body: a volume and the rig that poses it.

tissues   names and kinds of the labels, instead of the volume's own
bones     labels that are bone, as values in the file (default: from the table, or found automatically)
bone_map  {"label or label@left": "rig bone"}: the rig bone that each label follows)")
      .def(py::init(&body_from), py::arg("volume"), py::arg("rig"), py::kw_only(), py::arg("tissues") = nullptr,
           py::arg("bones") = std::vector<double>(), py::arg("bone_map") = BoneMap())
      .def_property_readonly("volume",
                             [](const std::shared_ptr<Body>& body) {
                               return Volume{std::shared_ptr<const VolumeFile>(body, &body->file)};
                             })
      .def_property_readonly(
          "rig", [](const Body& body) -> const Armature& { return body.rig; },
          py::return_value_policy::reference_internal)
      .def_property_readonly(
          "tissues", [](const Body& body) -> const TissueTable& { return body.tissues; },
          py::return_value_policy::reference_internal)
      .def_readonly("warnings", &Body::warnings, "Warnings about the inputs.")
      .def("weights", &weights_of, py::arg("method") = "heat", py::kw_only(), py::arg("seams") = py::none(),
           py::arg("progress") = py::none(), R"(Computes the skin weights: how tissue follows the bones.

method    heat (smoothest), geodesic (faster) or rigid (one bone per voxel)
seams     where tissue touches without being connected: None (found), "none", or a file of limber prepare --seams
progress  a function of (stage, fraction), or a tqdm bar)")
      .def("read_weights", &read_weights_of, py::arg("path"), py::kw_only(), py::arg("seams") = py::none(),
           py::arg("progress") = py::none(), "Reads weights from a file or a folder.");

  py::class_<Weights>(module, "Weights", "How the tissue of a body follows its bones: up to four bones for each voxel.")
      .def_property_readonly("body", [](const Weights& w) { return std::const_pointer_cast<Body>(w.body); })
      .def_property_readonly(
          "bones", [](const Weights& w) { return w.bound->weights.bones(); }, "Names of the bones.")
      .def("__len__", [](const Weights& w) { return w.bound->tissue.size(); })
      .def_property_readonly("voxels", &voxels_of,
                             "N x 3: the indices of all tissue voxels, in the order of influences().")
      .def("influences", &influences_of,
           "Returns (bones, weights), N x 4 each: indices into Weights.bones, and parts of 65535 that sum to 65535.")
      .def("with_influences", &with_influences, py::arg("bones"), py::arg("weights"),
           R"(Returns other weights for the same body.

bones, weights  N x 4, in the order of Weights.voxels; the weights of a voxel are scaled to a sum of 1)")
      .def("volume_of", &weight_volume, py::arg("bone"), "Returns float32 [x, y, z]: the weight of a bone, 0 in air.")
      .def_property_readonly("warnings", [](const Weights& w) { return w.bound->warnings; })
      .def("save", &save_weights, py::arg("path"), "Writes the weights (.nrrd).")
      .def("move_points", &move_points, py::arg("points"), py::arg("pose"), py::arg("method") = "dqs",
           "Returns N x 3: points at rest (N x 3, LPS mm) moved into a pose like the tissue around them.")
      .def(
          "resample",
          [](const Weights& weights, const py::object& poses, const std::string& method, const std::string& glide,
             const std::string& quality, const std::string& mesher, bool contact, bool nearest, bool mass_exact,
             bool fit_joints, std::optional<double> spacing, bool report, bool displacement, bool jacobian,
             bool overlap, const py::object& grey, const py::object& progress) {
            return resample_body(weights, poses,
                                 {method, glide, quality, mesher, contact, nearest, mass_exact, fit_joints, report,
                                  displacement, jacobian, overlap, spacing},
                                 grey, progress);
          },
          py::arg("pose"), py::arg("method") = deformation_methods().front().word, py::kw_only(),
          py::arg("glide") = "joint", py::arg("quality") = "", py::arg("mesher") = "", py::arg("contact") = false,
          py::arg("nearest") = false, py::arg("mass_exact") = false, py::arg("fit_joints") = false,
          py::arg("spacing") = py::none(), py::arg("report") = false, py::arg("displacement") = false,
          py::arg("jacobian") = false, py::arg("overlap") = false, py::arg("grey") = py::none(),
          py::arg("progress") = py::none(), R"(Computes the posed volume; for a list of poses, returns a list.

method        lbs, dqs, mix or fem
glide         largest shift of joints whose bones would overlap: joint, voxel, off, or mm as a string (the command
              line uses voxel for poses from files and motions, because their feet should not move)
quality       fem: draft, normal or fine; mesher: lattice or tetgen; contact: skin presses against skin
nearest       takes the label of the nearest voxel at rest, without interpolation and repairs
mass_exact    soft tissues keep their rest volumes
fit_joints    fits the axes of joints to the bones first
spacing       voxel size of the result, mm (default: the volume's)
report        measures the result: PosedVolume.report
displacement, jacobian, overlap  fill the fields of these names
grey          float array of the volume's shape (a CT) that is posed with it
progress      a function of (stage, fraction), or a tqdm bar)");

  py::class_<PosedVolume>(module, "PosedVolume", "A body in a pose.")
      .def_readonly("volume", &PosedVolume::volume)
      .def_property_readonly(
          "labels",
          [](const PosedVolume& p) {
            return voxel_array(p.volume.file->volume.grid, p.volume.file->volume.voxels.data(), p.volume.file);
          },
          "uint16 [x, y, z], read-only, x fastest in memory; not a copy.")
      .def_readonly("rig", &PosedVolume::rig,
                    "The body's rig; its joints are fitted to the pose if fit_joints was set.")
      .def_readonly("pose", &PosedVolume::pose,
                    "The pose that was reached, for the rig in .rig, including the shifts of joints.")
      .def_readonly("reached", &PosedVolume::reached,
                    "Share of the pose that fem reached, from 0 (rest) to 1 (the whole pose).")
      .def_property_readonly("report", &report_of,
                             "The report as a dict, as the command line writes it; None if report was not set.")
      .def_readonly("warnings", &PosedVolume::warnings)
      .def_property_readonly("displacement", &displacement_of,
                             "float32 [x, y, z, 3]: posed minus rest position, mm; None if displacement was not set.")
      .def_property_readonly(
          "jacobian", [](const PosedVolume& p) { return field_of(p, p.posed->jacobian); },
          "float32 [x, y, z]: posed / rest volume at each voxel; None if jacobian was not set.")
      .def_property_readonly(
          "overlap", [](const PosedVolume& p) { return field_of(p, p.posed->overlap); },
          "uint16 [x, y, z]: 1 where tissue overlaps, 2 where bones overlap; None if overlap was not set.")
      .def_property_readonly("grey", &grey_of,
                             "float32 [x, y, z]: the grey values in the pose; None if no grey was given.")
      .def(
          "save",
          [](const PosedVolume& p, const Path& path) {
            const py::gil_scoped_release without_lock;
            check_writable(path);
            write_volume(p.volume.file->volume, path, p.volume.file->tissues, p.volume.file->type);
          },
          py::arg("path"), "Writes the posed volume; the file's extension selects the format.");

  module.def("export", &export_volume, py::arg("volume"), py::arg("path"), py::kw_only(),
             py::arg("frequency") = py::none(), py::arg("progress") = py::none(),
             "Writes a volume for another program; the file's extension selects the format. frequency: Hz, needed for "
             "materials that depend on it.");
  module.def("make_phantom", &make_phantom, py::arg("name") = "arm", py::kw_only(), py::arg("spacing") = py::none(),
             "Makes a procedural sample body, arm or body, and returns (volume, rig, motion). spacing: mm.");
}

}  // namespace limber::python
