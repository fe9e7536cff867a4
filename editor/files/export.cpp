// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/files/export.h"

#include <algorithm>
#include <cstdio>
#include <numbers>

#include "core/base/error.h"
#include "core/base/output_files.h"
#include "core/export/exporter.h"
#include "core/export/gltf.h"
#include "core/export/tet_phantom.h"
#include "core/motion/bvh.h"
#include "core/motion/played_motion.h"
#include "core/pose/pose_io.h"
#include "core/report/fem_measures.h"
#include "core/rig_io/rig_io.h"
#include "core/skin/weights_io.h"
#include "core/study/session_page.h"
#include "core/volume_io/volume_io.h"
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/open_project.h"
#include "editor/context/platform_window.h"
#include "editor/context/preferences.h"
#include "editor/context/screen.h"
#include "editor/dialogs/confirm_dialog.h"
#include "editor/dialogs/form_dialog.h"
#include "editor/figure/video.h"
#include "editor/file_browser/temp_folder.h"
#include "editor/files/picture_files.h"
#include "editor/files/study_pictures.h"
#include "editor/resample/results.h"
#include "editor/ui/icons.h"
#include "editor/ui/messages.h"
#include "editor/volume/shown_image.h"
#include "render/image_io.h"

namespace limber::editor {

namespace {

// Returns the rig's motion in the active clip's frame range; without a rig, returns the clip's own motion.
Motion motion_of_clip(const Document& document) {
  const std::shared_ptr<const Clip> clip = document.clips[static_cast<std::size_t>(document.clip)];
  if (!document.armature) return *clip->motion;
  return played_motion(clip, document.armature);
}

void write_export(ExportKind kind, const Document& document, const Path& path, Progress& progress) {
  switch (kind) {
    case ExportKind::Volume:
      return write_volume(*document.volume, path, *document.tissues,
                          document.volume_type ? *document.volume_type : FileType{});
    case ExportKind::Tissues: return write_tissue_table(*document.tissues, path);
    case ExportKind::Rig: return write_armature(*document.armature, path);
    case ExportKind::Weights:
      return write_weights(*document.weights, *document.volume, TissueVoxels(*document.volume), path);
    case ExportKind::Pose: return write_pose(*document.pose, *document.armature, path);
    case ExportKind::Motion: return write_bvh(motion_of_clip(document), path);
    case ExportKind::Gltf:
      return write_glb({*document.volume, *document.tissues, *document.armature, *document.weights}, document.clips,
                       path, {}, progress);
  }
}

void check_export(ExportKind kind, const Path& path) {
  if (kind == ExportKind::Volume) check_writable(path);
  else if (kind == ExportKind::Rig) check_armature_writable(path);
  else if (kind == ExportKind::Weights) check_weights_writable(path);
  else check_place(path);
}

// A video of a turntable makes one turn in five seconds.
constexpr int kPicturesOfVideo = 5 * kPicturesPerSecond;

render::Camera turned_about(const render::Camera& camera, double angle) {
  render::Camera result = camera;
  result.world_from_view = glm::normalize(glm::angleAxis(angle, glm::dvec3(0, 0, 1)) * camera.world_from_view);
  return result;
}

}  // namespace

std::string why_not_export(const Document& document, ExportKind kind) {
  switch (kind) {
    case ExportKind::Volume:
    case ExportKind::Tissues: return document.volume ? "" : "Open a volume first";
    case ExportKind::Rig: return document.armature ? "" : "Import a rig first";
    case ExportKind::Weights: return document.weights ? "" : "Compute the weights first";
    case ExportKind::Pose: return document.pose ? "" : "There is no pose yet: pose the rig first";
    case ExportKind::Motion:
      return document.shown_clip() && (document.armature || document.shown_clip()->motion)
                 ? ""
                 : "There is no motion yet: import a motion first";
    case ExportKind::Gltf:
      return !document.volume     ? "Open a volume first"
             : !document.armature ? "Import a rig first"
             : document.weights   ? ""
                                  : "Compute the weights first";
  }
  return "";
}

void export_file(Context& context, ExportKind kind, const Path& path) {
  check_export(kind, path);
  start_task(context, "Export " + path.filename().string(),
             [kind, path, document = context.document()](Progress& progress) -> Finish {
               progress.update("write", 0);
               write_export(kind, document, path, progress);
               return [path](Context& c) {
                 c.messages->ok("Exported " + path.filename().string(), path.parent_path().string());
               };
             });
}

namespace {

// Returns the posed mesh for exporters. A tet's label is the most frequent label of the voxels inside it at rest.
TetMesh posed_mesh(const Result& result, const TissueTable& tissues) {
  const SolvedMesh& solved = *result.solved;
  const LabelVolume& rest = *result.from_volume;
  const TissueVoxels tissue(rest);
  const std::vector<std::int32_t> tets = tets_of_voxels(solved.mesh.tets.T, solved.mesh.tets.V, rest.grid, tissue);
  std::vector<std::map<Label, int>> counts(static_cast<std::size_t>(solved.mesh.tets.T.rows()));
  tissue.for_each([&](std::int64_t place, const glm::ivec3& voxel) {
    if (const std::int32_t tet = tets[static_cast<std::size_t>(place)]; tet >= 0)
      ++counts[static_cast<std::size_t>(tet)][rest.at(voxel)];
  });
  std::vector<Label> labels;
  for (const auto& count : counts)
    labels.push_back(count.empty() ? Label{0}
                                   : std::max_element(count.begin(), count.end(), [](const auto& x, const auto& y) {
                                       return x.second < y.second;
                                     })->first);
  return organ_mesh(solved.V, solved.mesh.tets.T, labels, tissues);
}

std::vector<TissueMaterial> materials_at(const TissueTable& tissues, double frequency) {
  TissueMaterials found = tissue_materials(tissues, read_dielectric_table(), frequency);
  std::string unmatched;
  for (const std::string& name : found.unmatched) unmatched += (unmatched.empty() ? "" : ", ") + name;
  if (!unmatched.empty())
    throw Error("no dielectric properties are known for: " + unmatched, "tissues",
                "rename or merge these tissues, or convert the exported volume with `limber convert --properties`");
  return std::move(found.materials);
}

bool has_mesh(const Result& result) { return result.solved && result.from_volume; }

void write_with(const Exporter& exporter, const Result& result, const TissueTable& tissues, const Path& path,
                double frequency, Progress& progress, std::vector<std::string>& warnings) {
  std::vector<TissueMaterial> materials;
  if (exporter.needs_frequency) materials = materials_at(tissues, frequency);
  if (std::string text = stand_ins_text(materials); !text.empty()) warnings.push_back(std::move(text));
  std::optional<TetMesh> mesh;
  if (exporter.takes_mesh && has_mesh(result)) mesh = posed_mesh(result, tissues);
  write_export(exporter,
               {*result.volume, tissues, std::move(materials), frequency, mesh ? &*mesh : nullptr, progress, warnings},
               path);
}

// Starts the task that writes a result to a file.
//   frequency  frequency of the field that another program will simulate, Hz; used by exporters of electric properties
void start_export(Context& context, const std::shared_ptr<const Result>& result, const Path& path, double frequency) {
  const Document& document = context.document();
  const auto tissues = result->from_tissues ? result->from_tissues : document.tissues;
  start_task(context, "Export " + path.filename().string(),
             [result, path, frequency, tissues,
              type = document.volume_type ? *document.volume_type : FileType{}](Progress& progress) -> Finish {
               progress.update("write", 0);
               std::vector<std::string> warnings;
               const Exporter* exporter = exporter_for(path);
               if (!exporter) write_volume(*result->volume, path, *tissues, type);
               else write_with(*exporter, *result, *tissues, path, frequency, progress, warnings);
               return [path, warnings](Context& c) {
                 c.messages->ok("Exported " + path.filename().string(), path.parent_path().string());
                 for (const std::string& warning : warnings) c.messages->warn(path.filename().string(), warning);
               };
             });
}

void ask_frequency(Context& context, const std::shared_ptr<const Result>& result, const Path& path) {
  const auto tissues = result->from_tissues ? result->from_tissues : context.document().tissues;
  const auto outcome = [tissues](const Context&, const std::vector<FormField>& fields) {
    return std::to_string(materials_at(*tissues, fields[0].value * 1e6).size()) +
           " tissues get permittivity and conductivity from the published tables.";
  };
  const auto act = [result, path](Context& c, const std::vector<FormField>& fields) {
    start_export(c, result, path, fields[0].value * 1e6);
  };
  context.dialogs->open(make_form({"Export " + path.filename().string(),
                                   "The permittivity and conductivity of tissue depend on the frequency of the field.",
                                   "Export",
                                   {number_of("Frequency", "The frequency of the simulated field.", 900,
                                              kLowestFrequency / 1e6, kHighestFrequency / 1e6, "%g", "MHz")},
                                   outcome,
                                   act,
                                   {}}));
}

// Starts the task that writes a report page of all results, oldest first, and opens it.
void export_page(Context& context, const Path& path) {
  const Document& document = context.document();
  SessionPage session{
      context.project->name.empty() ? "Untitled" : Path(context.project->name).stem().string(), {}, document.tissues};
  for (const auto& result : document.results)
    session.results.push_back({result, result->from_armature && result->from_pose
                                           ? name_of_pose(*result->from_armature, *result->from_pose)
                                           : result->name});
  start_task(context, "Report " + path.filename().string(),
             [session, path, scratch = context.preferences->scratch_folder](Progress& progress) -> Finish {
               const ScratchFolder folder(scratch);
               write_file_atomically(path, session_page(session, folder.path(), start_pictures, progress));
               return [path](Context& c) {
                 c.messages->ok((c.host->open_file(path) ? "Opened " : "Wrote ") + path.filename().string(),
                                path.parent_path().string());
               };
             });
}

}  // namespace

void export_result(Context& context, const std::shared_ptr<const Result>& result, const Path& path) {
  const Exporter* exporter = exporter_for(path);
  if (exporter) check_place(path);
  else check_writable(path);
  if (exporter && !exporter->takes_voxels && !has_mesh(*result))
    throw Error("the result has no mesh", result->name, "select a FEM result whose pose bends a joint");
  if (exporter && exporter->needs_frequency) ask_frequency(context, result, path);
  else start_export(context, result, path, 0);
}

void export_posed_image(Context& context, const std::shared_ptr<const Result>& result, const Path& path) {
  check_writable(path);
  const PosedImage* kept = posed_image_of(*context.views, result->volume);
  if (!kept) throw Error("this result was made without an image", result->name, "show the image, and resample again");
  // The task holds the folder of the posed image, so that the folder remains even if the result is deleted meanwhile.
  start_task(context, "Export " + path.filename().string(),
             [file = kept->file, folder = kept->folder, path](Progress& progress) -> Finish {
               write_grey_volume(read_grey_volume(file, progress), path);
               return [path](Context& c) {
                 c.messages->ok("Exported " + path.filename().string(), path.parent_path().string());
               };
             });
}

void export_report(Context& context, const std::shared_ptr<const Result>& result, const Path& path) {
  check_place(path);
  if (path.extension() == ".html") return export_page(context, path);
  const std::string text =
      path.extension() == ".json" ? result->report : text_of_report(result->name, *facts_of(context, result));
  start_task(context, "Report " + path.filename().string(), [text, path](Progress&) -> Finish {
    write_file_atomically(path, text);
    return [path](Context& c) { c.messages->ok("Wrote " + path.filename().string(), path.parent_path().string()); };
  });
}

void export_picture(Context& context, const Path& path) {
  check_place(path);
  Views& views = *context.views;
  const auto done = [path](Progress&) -> Finish {
    return [path](Context& c) { c.messages->ok("Exported " + path.filename().string(), path.parent_path().string()); };
  };
  const std::string label = "Export " + path.filename().string();
  if (views.active == ViewId::Body || !context.screen->layout.place_of(views.active))
    return start_picture_task(
        context, {.label = label,
                  .scene = drawn_scene(views),
                  .size = size_of_view(context.screen, views.active),
                  .camera = [camera = views.body.camera](int) { return camera; },
                  .prepare = {},
                  .take = [path](int, const render::Image& image, Progress&) { render::write_png(image, path); },
                  .finish = done});
  auto image = std::make_shared<render::Image>(slice_of(views, views.active).picture->read());
  start_task(context, label, [path, image, done](Progress& progress) -> Finish {
    render::write_png(*image, path);
    return done(progress);
  });
}

namespace {

void begin_turntable(Context& context, const Path& path, int pictures) {
  const render::Camera from = context.views->body.camera;
  start_picture_files(
      context, path,
      {.label = "Export turntable",
       .scene = drawn_scene(context.views),
       .size = size_of_view(context.screen, ViewId::Body),
       .pictures = pictures,
       .camera = [from, pictures](int i) { return turned_about(from, 2 * std::numbers::pi * i / pictures); },
       .prepare = {},
       .take = {},
       .finish = {}});
}

}  // namespace

void export_turntable(Context& context, const Path& path, int pictures) {
  const int count = is_video(path) ? kPicturesOfVideo : pictures;
  agree_on_pictures(context, path, count, [path, count](Context& c) { begin_turntable(c, path, count); });
}

}  // namespace limber::editor
