// SPDX-License-Identifier: AGPL-3.0-or-later
// Python classes for volumes and tissues.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "core/base/error.h"
#include "core/python/arrays.h"
#include "core/python/module.h"
#include "core/python/python_call.h"
#include "core/report/report.h"
#include "core/volume_io/label_decoder.h"
#include "core/volume_io/volume_header.h"

namespace py = pybind11;

namespace limber::python {

namespace {

// Converts between nibabel's world axes (RAS) and Limber's (LPS), in which x and y have opposite signs.
const glm::dmat3 kFlip(glm::dvec3(-1, 0, 0), glm::dvec3(0, -1, 0), glm::dvec3(0, 0, 1));

py::array_t<double> affine_of(const Grid& grid) {
  const AffineTransform lps = world_from_voxel(grid);
  const glm::dmat3 linear = kFlip * lps.linear;
  const glm::dvec3 offset = kFlip * lps.offset;
  py::array_t<double> affine({4, 4});
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      affine.mutable_at(row, column) = row == 3 ? double(column == 3) : column == 3 ? offset[row] : linear[column][row];
  return affine;
}

Grid grid_from(const std::array<py::ssize_t, 3>& shape, const py::object& spacing, const py::object& origin,
               const py::object& direction, const py::object& affine) {
  const std::vector<std::int64_t> sizes(shape.begin(), shape.end());
  RawGrid raw{sizes};
  if (!affine.is_none()) {
    if (!spacing.is_none() || !origin.is_none() || !direction.is_none())
      throw py::value_error("affine: it replaces spacing, origin and direction; leave these three out");
    const auto matrix = affine.cast<Doubles>();
    if (matrix.ndim() != 2 || matrix.shape(0) != 4 || matrix.shape(1) != 4)
      throw py::value_error("affine: give a matrix of 4 x 4 numbers");
    glm::dmat3 linear;
    glm::dvec3 offset;
    for (int row = 0; row < 3; ++row) {
      offset[row] = matrix.at(row, 3);
      for (int column = 0; column < 3; ++column) linear[column][row] = matrix.at(row, column);
    }
    raw = grid_from_columns(sizes, kFlip * linear, kFlip * offset);
  } else {
    if (!spacing.is_none()) raw.spacing = vector_from(spacing.cast<Doubles>(), "spacing");
    if (!origin.is_none()) raw.origin = vector_from(origin.cast<Doubles>(), "origin");
    if (!direction.is_none()) raw.direction = matrix_from(direction.cast<Doubles>(), "direction");
  }
  std::vector<std::string> warnings;
  const Grid grid = checked_grid(raw, "labels", warnings);
  warn_python(warnings);
  return grid;
}

bool is_x_fastest(const py::array& array) { return array.flags() & py::array::f_style; }

// Returns a volume that shares the memory of an array of 16-bit labels, x fastest.
VolumeFile shared_volume(const Grid& grid, const py::array_t<Label>& array) {
  VolumeFile file;
  file.volume.grid = grid;
  file.volume.voxels = ZeroedVector<Label>::of_owner(const_cast<Label*>(array.data()), std::size_t(array.size()),
                                                     owner_of(py::object(array)));
  return file;
}

TissueTable tissues_in(const LabelVolume& volume) {
  std::vector<std::uint8_t> is_there(65536, 0);
  for (const Label label : volume.voxels) is_there[label] = 1;
  std::vector<std::pair<Label, double>> values;
  for (int label = 1; label < 65536; ++label)
    if (is_there[label]) values.emplace_back(Label(label), label);
  return tissues_of_values(values, {});
}

// Returns a volume with a copy of the labels of an array of any other type or order.
VolumeFile decoded_volume(const Grid& grid, const py::array& array) {
  const auto type = voxel_type_from_text(py::str(array.dtype().attr("name")).cast<std::string>());
  if (!type) throw py::type_error("labels: give an array of whole numbers");
  const py::array ordered =
      py::module_::import("numpy").attr("asfortranarray")(array, array.dtype().attr("newbyteorder")("="));
  VolumeFile file;
  file.volume.grid = grid;
  file.volume.voxels.resize(std::size_t(grid.voxel_count()));
  LabelDecoder decoder;
  const auto problem =
      decoder.decode(ordered.data(), file.volume.voxels.size(), *type, 1, 0, file.volume.voxels.data());
  if (problem != LabelDecoder::Problem::None)
    throw Error("the array holds values that are not labels", "labels",
                "give whole numbers up to 2^53, of at most 65 535 different values");
  file.tissues = tissues_of_values(decoder.values(), {});
  return file;
}

Volume volume_from(const py::array& labels, const py::object& spacing, const py::object& origin,
                   const py::object& direction, const py::object& affine, const TissueTable* tissues) {
  if (labels.ndim() != 3) throw py::value_error("labels: give an array of three axes, [x, y, z]");
  const Grid grid = grid_from({labels.shape(0), labels.shape(1), labels.shape(2)}, spacing, origin, direction, affine);
  VolumeFile file;
  if (py::isinstance<py::array_t<Label>>(labels) && is_x_fastest(labels)) {
    file = shared_volume(grid, labels.cast<py::array_t<Label>>());
    file.tissues = tissues_in(file.volume);
  } else {
    file = decoded_volume(grid, labels);
  }
  file.type = {"NumPy", py::str(labels.dtype().attr("name")).cast<std::string>(), false};
  if (tissues) file.tissues = merge_tissue_tables(file.tissues, tissues);
  return volume_of(std::move(file));
}

Volume read_volume_from(const Path& path, const py::object& progress) {
  VolumeFile file = call_with_result(progress, [&](Progress& shown) { return read_volume(path, shown); });
  warn_python(file.warnings);
  file.tissues = merge_tissue_tables(file.tissues, nullptr);
  return volume_of(std::move(file));
}

void save_volume(const Volume& volume, const Path& path) {
  const py::gil_scoped_release without_lock;
  check_writable(path);
  write_volume(volume.file->volume, path, volume.file->tissues, volume.file->type);
}

py::object compare_volumes(const Volume& before, const Volume& after) {
  std::string text;
  {
    const py::gil_scoped_release without_lock;
    Report report;
    report.metrics = compare(before.file->volume, after.file->volume, before.file->tissues);
    text = to_json(report);
  }
  return py::module_::import("json").attr("loads")(text);
}

std::vector<double> colour_of(const Tissue& tissue) { return {tissue.colour.x, tissue.colour.y, tissue.colour.z}; }

Tissue tissue_from(double value, const std::string& name, const std::string& kind) {
  Tissue tissue;
  tissue.file_value = value;
  if (value >= 1 && value <= 65535) tissue.label = Label(value);
  tissue.name = name;
  tissue.kind = kind.empty() ? tissue_kind_from_name(name) : TissueKind::Unknown;
  if (!kind.empty()) {
    const auto known = tissue_kind_from_text(kind);
    if (!known) throw Error("there is no such kind of tissue", kind, "write one such as bone, muscle, fat or skin");
    tissue.kind = *known;
  }
  apply_kind_defaults(tissue);
  return tissue;
}

const Tissue& tissue_of(const TissueTable& table, const py::object& key) {
  const bool is_name = py::isinstance<py::str>(key);
  if (!is_name) {
    if (const Tissue* tissue = table.find_file_value(key.cast<double>())) return *tissue;
    throw py::key_error("no tissue has the value " + py::str(key).cast<std::string>());
  }
  for (const Tissue& tissue : table.tissues)
    if (tissue.name == key.cast<std::string>()) return tissue;
  throw py::key_error("no tissue has the name " + key.cast<std::string>());
}

}  // namespace

VolumeFile shared_copy(const Volume& volume) {
  const VolumeFile& file = *volume.file;
  auto* voxels = const_cast<Label*>(file.volume.voxels.data());
  return {{file.volume.grid, ZeroedVector<Label>::of_owner(voxels, file.volume.voxels.size(), volume.file)},
          file.tissues,
          file.type,
          file.warnings};
}

Volume volume_of(VolumeFile file) { return {std::make_shared<const VolumeFile>(std::move(file))}; }

void add_volumes(py::module_& module) {
  py::class_<Tissue>(module, "Tissue", "A tissue: the name, kind and colour of a label.")
      .def(py::init(&tissue_from), py::arg("value"), py::arg("name"), py::arg("kind") = "",
           "kind: bone, cortical bone, muscle, fat, skin ...; without it, the kind is taken from words in the name.")
      .def_readonly("value", &Tissue::file_value, "The voxels' value in files and arrays.")
      .def_readonly("label", &Tissue::label, "The voxels' value in Volume.labels.")
      .def_readonly("name", &Tissue::name)
      .def_property_readonly("kind", [](const Tissue& tissue) { return std::string(to_string(tissue.kind)); })
      .def_property_readonly("is_bone", [](const Tissue& tissue) { return is_bone(tissue.kind); })
      .def_property_readonly("colour", &colour_of, "Red, green, blue: sRGB from 0 to 1.")
      .def_readonly("density", &Tissue::density, "g/cm3")
      .def_readonly("priority", &Tissue::priority,
                    "Where two tissues meet in a voxel, the voxel gets the tissue with the higher priority.")
      .def("__repr__", [](const Tissue& tissue) {
        return "<Tissue " + std::to_string(tissue.label) + " " + tissue.name + " (" +
               std::string(to_string(tissue.kind)) + ")>";
      });

  py::class_<TissueTable>(module, "Tissues", "The tissues of a volume, one for each label.")
      .def(py::init([](std::vector<Tissue> tissues) {
             return TissueTable{std::move(tissues), "Python"};
           }),
           py::arg("tissues"))
      .def("__len__", [](const TissueTable& table) { return table.tissues.size(); })
      .def(
          "__iter__",
          [](const TissueTable& table) { return py::make_iterator(table.tissues.begin(), table.tissues.end()); },
          py::keep_alive<0, 1>())
      .def("__getitem__", &tissue_of, py::return_value_policy::reference_internal, py::arg("value_or_name"))
      .def_readonly("source", &TissueTable::source, "The file or table that names and kinds come from.")
      .def("save", &write_tissue_table, py::arg("path"), "Writes a table: .json, .ctbl (Slicer) or .txt (ITK-SNAP).");

  py::class_<Volume>(module, "Volume", R"(A label volume. It never changes.

labels     array [x, y, z] of whole numbers; 0 is air. A uint16 array with x fastest in memory (Fortran order) is
           shared, not copied: do not change it while the volume is in use. Any other array is copied.
spacing    mm along x, y, z (default 1); origin: centre of voxel (0, 0, 0) in LPS mm (default 0); direction: 3 x 3, its
           columns are the unit vectors of the axes (default: the world's).
affine     4 x 4, from voxel indices to RAS mm, as nibabel has it; instead of spacing, origin and direction.
tissues    names and kinds of the labels.)")
      .def(py::init(&volume_from), py::arg("labels"), py::kw_only(), py::arg("spacing") = py::none(),
           py::arg("origin") = py::none(), py::arg("direction") = py::none(), py::arg("affine") = py::none(),
           py::arg("tissues") = nullptr)
      .def_property_readonly(
          "labels",
          [](const Volume& v) { return voxel_array(v.file->volume.grid, v.file->volume.voxels.data(), v.file); },
          "uint16 [x, y, z], read-only, x fastest in memory; not a copy.")
      .def_property_readonly("shape",
                             [](const Volume& v) {
                               const glm::ivec3 size = v.file->volume.grid.size;
                               return py::make_tuple(size.x, size.y, size.z);
                             })
      .def_property_readonly(
          "spacing", [](const Volume& v) { return array_of(v.file->volume.grid.spacing); }, "mm along x, y, z")
      .def_property_readonly(
          "origin", [](const Volume& v) { return array_of(v.file->volume.grid.origin); },
          "Centre of voxel (0, 0, 0), LPS mm.")
      .def_property_readonly(
          "direction", [](const Volume& v) { return array_of(v.file->volume.grid.direction); },
          "3 x 3: its columns are the unit vectors of the voxel axes, LPS.")
      .def_property_readonly(
          "affine", [](const Volume& v) { return affine_of(v.file->volume.grid); },
          "4 x 4, from voxel indices to RAS mm, as nibabel has it.")
      .def_property_readonly(
          "tissues", [](const Volume& v) -> const TissueTable& { return v.file->tissues; },
          py::return_value_policy::reference_internal)
      .def_property_readonly("warnings", [](const Volume& v) { return v.file->warnings; })
      .def("save", &save_volume, py::arg("path"), "Writes the volume; the file's extension selects the format.")
      .def("__repr__", [](const Volume& v) {
        const Grid& grid = v.file->volume.grid;
        char text[160];
        std::snprintf(text, sizeof text, "<Volume %d x %d x %d voxels of %g x %g x %g mm, %zu tissues>", grid.size.x,
                      grid.size.y, grid.size.z, grid.spacing.x, grid.spacing.y, grid.spacing.z,
                      v.file->tissues.tissues.size());
        return std::string(text);
      });

  module.def("read_volume", &read_volume_from, py::arg("path"), py::kw_only(), py::arg("progress") = py::none(),
             "Reads a label volume: NRRD, MetaImage, NIfTI, VTK image, DICOM or Virtual Family.");
  module.def("read_tissues", &read_tissue_table, py::arg("path"),
             "Reads a tissue table: JSON, Slicer .ctbl or ITK-SNAP.");
  module.def("compare", &compare_volumes, py::arg("before"), py::arg("after"),
             "Returns what changed between two volumes of a body, as `limber report` states it.");
}

}  // namespace limber::python
