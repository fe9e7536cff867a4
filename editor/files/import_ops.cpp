// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators that import files into the open project.
#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/context/open_project.h"
#include "editor/context/operator.h"
#include "editor/context/operator_polls.h"
#include "editor/file_browser/file_browser.h"
#include "editor/files/file_filters.h"
#include "editor/files/import.h"
#include "editor/files/project_session.h"
#include "editor/motion/motion_clip_edits.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

struct ImportFacts {
  const char *id, *label, *description;
  FileKind kind;
  FileFilter filter;
};

Operator import_operator(const ImportFacts& facts, std::string (*disabled_reason)(const Context&)) {
  return {facts.id,
          facts.label,
          icon::kImport,
          "Import",
          facts.description,
          [facts](Context& c) {
            browse(c, {.purpose = facts.id,
                       .title = std::string("Import: ") + facts.label,
                       .action = "Import",
                       .filters = {facts.filter},
                       .takes_dicom = facts.kind == FileKind::Volume,
                       .folder = c.project->path.parent_path(),
                       .chosen = [kind = facts.kind](Context& c, const Path& path) {
                         kind == FileKind::Motion ? import_motion(c, path) : import_file(c, kind, path);
                       }});
          },
          disabled_reason};
}

void import_dicom(Context& context) {
  browse(context, {.purpose = "dicom",
                   .title = "Import a folder of DICOM images",
                   .action = "Open this folder",
                   .kind = FileRequest::Kind::OpenFolder,
                   .takes_dicom = true,
                   .chosen = [](Context& c, const Path& path) { open_files(c, {path}); }});
}

void import_image(Context& context) {
  browse(context, {.purpose = "image",
                   .title = "Import a grey image (CT, MR)",
                   .action = "Import",
                   .filters = {volume_files()},
                   .takes_dicom = true,
                   .chosen = [](Context& c, const Path& path) { open_image(c, path); }});
}

// Imports a file of any kind. A volume replaces the open volume; any other file is added to the open project.
void import_any(Context& context) {
  browse(context, {.purpose = "import",
                   .title = "Import",
                   .action = "Import",
                   .filters = {readable_files()},
                   .takes_dicom = true,
                   .chosen = [](Context& c, const Path& path) {
                     start_task(c, "Import " + path.filename().string(), [path](Progress&) -> Finish {
                       const FileKind kind = kind_of(path);
                       return [kind, path](Context& c) {
                         kind == FileKind::Project  ? open_project(c, path)
                         : kind == FileKind::Motion ? import_motion(c, path)
                                                    : import_file(c, kind, path);
                       };
                     });
                   }});
}

std::string needs_rig_and_volume(const Context& context) {
  return !context.document().volume ? "Open a volume first" : !context.document().armature ? "Import a rig first" : "";
}
std::string needs_rig(const Context& context) { return context.document().armature ? "" : "Import a rig first"; }

}  // namespace

std::vector<Operator> import_operators() {
  return {
      {"file.import", "Import...", icon::kImport, "File", "Import a file of any kind into the open project.",
       import_any},
      import_operator({"file.import_volume", "Volume...",
                       "Import a volume in place of the open one. Removes everything made for the old volume.",
                       FileKind::Volume, volume_files()},
                      nullptr),
      {"file.import_dicom", "DICOM folder...", icon::kImport, "Import", "Open a folder of DICOM images as one volume.",
       import_dicom},
      {"file.import_image", "Image...", icon::kImport, "Import",
       "Show a grey image with the open body, or by itself. Slices show it below the tissues; it moves with the pose.",
       import_image},
      import_operator({"file.import_rig",
                       "Rig...",
                       "Import a rig (skeleton) into the project.",
                       FileKind::Rig,
                       {"Rigs", {".json", ".vtk", ".arm", ".bvh", ".gltf", ".glb"}}},
                      nullptr),
      import_operator({"file.import_motion",
                       "Motion...",
                       "Import a BVH motion into the project.",
                       FileKind::Motion,
                       {"Motions", {".bvh"}}},
                      nullptr),
      import_operator({"file.import_weights",
                       "Weights...",
                       "Import skin weights into the project.",
                       FileKind::Weights,
                       {"Weights", {".nrrd", ".mha"}}},
                      needs_rig_and_volume),
      import_operator({"file.import_tissues",
                       "Tissues...",
                       "Import the names, colours and kinds of the tissues.",
                       FileKind::Tissues,
                       {"Tissue tables", {".json", ".ctbl", ".txt", ".label"}}},
                      needs_volume),
      import_operator({"file.import_pose",
                       "Pose...",
                       "Import a pose of the rig into the project.",
                       FileKind::Pose,
                       {"Poses", {".json"}}},
                      needs_rig),
  };
}

}  // namespace limber::editor
