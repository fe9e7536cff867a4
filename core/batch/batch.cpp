// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/batch/batch.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/batch/description.h"
#include "core/body/bind_body.h"
#include "core/body/glide_poses.h"
#include "core/export/exporter.h"
#include "core/volume_io/volume_format.h"

namespace limber {

namespace {
constexpr std::size_t kMostCells = 1000000;

void read_weights(const Description& value, DescribedBody& body) {
  body.weights = value.text("weights", body.weights);
  const std::vector<std::string> words = binding_words();
  if (std::find(words.begin(), words.end(), body.weights) != words.end()) return;
  if (body.spacing)
    value.refuse("weights from a file fit only the volume's own voxel size", "weights",
                 "leave out \"weights\" or \"spacing_mm\"");
  if (!body.phantom.empty()) value.refuse("a phantom's weights are always computed", "weights", "leave out the file");
  body.weights_file = value.file("weights");
}

DescribedBody read_body(const Description& value) {
  if (!value.is_object())
    value.refuse("a body must be a JSON object", R"(write {"name": "man", "volume": FILE, "rig": FILE})");
  value.check_keys({"name", "volume", "phantom", "rig", "tissues", "bones", "bone_map", "seams", "weights",
                    "spacing_mm", "with", "landmarks"});
  DescribedBody body = read_described_body(value, "an entry of \"bodies\"");
  body.name = value.text("name", body.phantom.empty() ? body.volume.stem().stem().string() : body.phantom);
  const bool is_phantom = !body.phantom.empty();
  body.spacing = value.number("spacing_mm", is_phantom ? 0.5 : 1e-3, is_phantom ? 10 : 1e3);
  read_weights(value, body);
  body.bone_map = value.file("bone_map");
  body.no_seams = value.text("seams") == "none";
  if (!body.no_seams) body.seams = value.file("seams");
  body.grey = value.file("with");
  body.landmarks = value.file("landmarks");
  return body;
}

bool is_ending(const std::string& text) { return text.starts_with('.') && text.find('/') == std::string::npos; }

BatchExport read_export(const Description& value) {
  BatchExport one;
  if (value.is_object()) {
    value.check_keys({"ending", "frequency_hz", "properties"});
    one.ending = value.text("ending");
    one.frequency = value.number("frequency_hz", 1, 1e15).value_or(0);
    one.properties = value.file("properties");
  } else {
    one.ending = value.as_text();
  }
  const Path name = "posed" + one.ending;
  const Exporter* exporter = is_ending(one.ending) ? exporter_for(name) : nullptr;
  if (!exporter && !(is_ending(one.ending) && how_written(name)))
    value.refuse("Limber writes no files with this extension: \"" + one.ending + "\"",
                 "write \".nii.gz\", \".stl\" or another that `limber convert` knows");
  if (exporter && !exporter->takes_voxels)
    value.refuse("this format needs a mesh: \"" + one.ending + "\"", "write \"mesh\": \"" + one.ending + "\"");
  if (exporter && exporter->needs_frequency && one.frequency == 0)
    value.refuse("this format needs the frequency of the field: \"" + one.ending + "\"",
                 R"(write {"ending": ")" + one.ending + R"(", "frequency_hz": 9e8})");
  return one;
}

CellSettings read_settings(const Description& description) {
  CellSettings settings;
  settings.quality = description.text("quality", settings.quality, {"draft", "normal", "fine"});
  settings.glide = description.text("glide");
  if (!settings.glide.empty()) glide_settings(settings.glide, 1, description.where("glide"));
  settings.fit_joints = description.flag("fit_joints");
  const std::string format = description.text("format", ".nrrd");
  if (!is_ending(format) || !how_written("posed" + format))
    description.refuse("volumes cannot be written with this extension: \"" + format + "\"", "format",
                       "use " + writable_endings());
  settings.outputs = {{"output", "posed" + format}, {"report", "report.json"}};
  for (const std::string& volume : description.texts("volumes")) {
    if (volume != "displacement" && volume != "jacobian" && volume != "overlap")
      description.refuse("there is no such volume: \"" + volume + "\"", "volumes",
                         "use displacement, jacobian or overlap");
    // The additional volumes contain vectors or fractions. Not every format for labels can store these, so they are
    // written as NRRD.
    settings.outputs[volume == "displacement" ? "field" : volume] = volume + ".nrrd";
  }
  const std::string mesh = description.text("mesh");
  const Exporter* exporter = is_ending(mesh) ? exporter_for("mesh" + mesh) : nullptr;
  if (!mesh.empty() && !(exporter && exporter->takes_mesh))
    description.refuse("meshes cannot be written with this extension: \"" + mesh + "\"", "mesh",
                       R"(write ".vtu" or ".node")");
  if (!mesh.empty()) settings.mesh = "mesh" + mesh;
  return settings;
}
}  // namespace

Batch read_batch(const Path& path) {
  const Description description(path, "batch");
  description.check_keys({"name", "bodies", "poses", "methods", "volumes", "format", "mesh", "exports", "quality",
                          "glide", "fit_joints", "nearest"});
  Batch batch{.name = description.text("name", path.stem().string()), .description = path};
  if (!description.has("bodies"))
    description.refuse("the batch has no bodies", R"(add "bodies": [{"name": "man", "volume": FILE, "rig": FILE}])");
  std::vector<std::string> names, endings;
  for (const Description& one : description.list("bodies")) {
    batch.bodies.push_back(read_body(one));
    names.push_back(batch.bodies.back().name);
  }
  check_distinct(description, "bodies, name", names);
  batch.poses = read_described_poses(description, "batch");
  batch.techniques = read_techniques(description, {"dqs"});
  if (batch.bodies.size() * batch.poses.size() * batch.techniques.size() > kMostCells)
    description.refuse("the batch has too many cells (combinations of body, pose and method)",
                       "split it into several batches");
  for (const Description& one : description.list("exports")) {
    batch.exports.push_back(read_export(one));
    endings.push_back(batch.exports.back().ending);
  }
  check_distinct(description, "exports", endings);
  batch.settings = read_settings(description);
  batch.settings.nearest = read_nearest(description, batch.techniques);
  return batch;
}

std::vector<BatchCell> cells_of(const Batch& batch) {
  std::vector<BatchCell> cells;
  for (int b = 0; b < std::ssize(batch.bodies); ++b)
    for (int p = 0; p < std::ssize(batch.poses); ++p)
      for (int t = 0; t < std::ssize(batch.techniques); ++t) cells.push_back({b, p, t});
  return cells;
}

std::string text_of(const Batch& batch, const BatchCell& cell) {
  return batch.bodies[cell.body].name + ", " + batch.poses[cell.pose].name + ", " +
         word_of(batch.techniques[cell.technique]);
}

}  // namespace limber
