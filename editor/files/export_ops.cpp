// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators that export parts of the project, results, reports and pictures.
#include <algorithm>
#include <cctype>

#include "core/export/exporter.h"
#include "core/motion/clip.h"
#include "editor/context/context.h"
#include "editor/context/open_project.h"
#include "editor/context/operator.h"
#include "editor/context/operator_polls.h"
#include "editor/file_browser/file_browser.h"
#include "editor/files/export.h"
#include "editor/files/export_figure.h"
#include "editor/files/file_filters.h"
#include "editor/files/picture_files.h"
#include "editor/resample/results.h"
#include "editor/ui/icons.h"
#include "editor/volume/shown_image.h"

namespace limber::editor {

namespace {

std::string stem_of(const Context& context) {
  return context.project->name.empty() ? "Untitled" : Path(context.project->name).stem().string();
}

// Returns the proposed file name for exports of the shown motion: the clip's name, without characters that file names
// cannot contain.
std::string motion_stem(const Context& context) {
  const Clip* clip = context.document().shown_clip();
  std::string name = clip ? clip->name : "";
  std::replace(name.begin(), name.end(), '/', '-');
  return name.empty() || name[0] == '.' ? stem_of(context) : name;
}

struct ExportFacts {
  const char *id, *label, *description;
  ExportKind kind;
  std::vector<FileFilter> filters;  // file formats; the proposed file name has the first ending of the first format
  const char* suffix;               // text that is appended to the proposed file name, before the ending
};

// Returns the dialog title for an operator's label: "glTF..." -> "Export glTF", "Motion..." -> "Export motion".
std::string title_of(const std::string& label) {
  std::string words = label.substr(0, label.find("..."));
  if (words.size() > 1 && std::islower(static_cast<unsigned char>(words[1])))
    words[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(words[0])));
  return "Export " + words;
}

Operator export_operator(const ExportFacts& facts) {
  return {facts.id,
          facts.label,
          icon::kExport,
          "Export",
          facts.description,
          [facts](Context& c) {
            browse(c, {.purpose = "export",
                       .title = title_of(facts.label),
                       .action = "Export",
                       .kind = FileRequest::Kind::Save,
                       .filters = facts.filters,
                       .name = (facts.kind == ExportKind::Motion ? motion_stem(c) : stem_of(c)) + facts.suffix +
                               facts.filters[0].ends[0],
                       .folder = c.project->path.parent_path(),
                       .chosen = [kind = facts.kind](Context& c, const Path& path) { export_file(c, kind, path); }});
          },
          [kind = facts.kind](const Context& c) { return why_not_export(c.document(), kind); }};
}

Operator picture_operator(const char* id, const char* label, const char* description,
                          std::string (*name)(const Context&), std::vector<FileFilter> filters,
                          void (*act)(Context&, const Path&)) {
  return {id,
          label,
          icon::kCamera,
          "Export",
          description,
          [label, name, filters, act](Context& c) {
            browse(c, {.purpose = "picture",
                       .title = title_of(label),
                       .action = "Export",
                       .kind = FileRequest::Kind::Save,
                       .filters = filters,
                       .name = name(c) + ".png",
                       .folder = c.project->path.parent_path(),
                       .chosen = act});
          },
          needs_volume};
}

Operator motion_pictures() {
  Operator op = picture_operator(
      "file.export_motion_pictures", "Motion as pictures...",
      "Export the playing range as seen in the 3D view: a video at the clip's speed, or a picture of each frame.",
      motion_stem, {{"PNG pictures", {".png"}}, {"MP4 video", {".mp4"}}, {"WebM video", {".webm"}}},
      ask_motion_pictures);
  op.disabled_reason = why_no_motion_pictures;
  return op;
}

// Returns a file name made of the project's and the result's names: "limb, Forearm, DQ". Replaces "/" by "-", because
// file names cannot contain it.
std::string file_name_of(const Context& context, const Result& result) {
  std::string name = stem_of(context) + ", " + result.name;
  std::replace(name.begin(), name.end(), '/', '-');
  return name;
}

// Opens the file browser and writes the result that is selected now to the file that the user names. This result is
// also written if the user selects another result before accepting the file name.
//   name  proposed file name without its ending
void browse_for_result(Context& context, const std::string& title, const char* purpose, const std::string& name,
                       const std::vector<FileFilter>& filters,
                       void (*write)(Context&, const std::shared_ptr<const Result>&, const Path&)) {
  const auto result = chosen_result(context);
  browse(context, {.purpose = purpose,
                   .title = title,
                   .action = "Export",
                   .kind = FileRequest::Kind::Save,
                   .filters = filters,
                   .name = name + filters[0].ends[0],
                   .folder = context.project->path.parent_path(),
                   .chosen = [result, write](Context& c, const Path& path) { write(c, result, path); }});
}

std::vector<FileFilter> formats_of(const Result& result) {
  std::vector<FileFilter> formats = writable_volumes();
  for (const Exporter& exporter : exporters())
    if (exporter.takes_voxels || result.solved) formats.push_back({exporter.name, exporter.endings});
  return formats;
}

std::string needs_result(const Context& context) {
  return context.document().results.empty() ? "Resample a pose first" : "";
}

std::string needs_posed_image(const Context& context) {
  if (const std::string reason = needs_result(context); !reason.empty()) return reason;
  const auto result = chosen_result(context);
  return result && posed_image_of(*context.views, result->volume)
             ? ""
             : "Show an image (File > Import), then resample again";
}

}  // namespace

std::vector<Operator> export_operators() {
  return {
      export_operator({"file.export_volume", "Volume...", "Export the volume with its labels.", ExportKind::Volume,
                       writable_volumes(), ""}),
      export_operator(
          {"file.export_tissues",
           "Tissues...",
           "Export the names, colours and kinds of the tissues.",
           ExportKind::Tissues,
           {{"Limber tissues", {".json"}}, {"Slicer colour table", {".ctbl"}}, {"ITK-SNAP labels", {".txt"}}},
           "-tissues"}),
      export_operator({"file.export_rig",
                       "Rig...",
                       "Export the rig in its rest pose.",
                       ExportKind::Rig,
                       {{"Limber rig", {".json"}}, {"Bender armature", {".vtk"}}, {"BVH", {".bvh"}}},
                       "-rig"}),
      export_operator({"file.export_weights",
                       "Weights...",
                       "Export the skin weights: how strongly each voxel follows each bone.",
                       ExportKind::Weights,
                       {{"Weights", {".nrrd"}}},
                       "-weights"}),
      export_operator({"file.export_pose",
                       "Pose...",
                       "Export the current pose of the rig.",
                       ExportKind::Pose,
                       {{"Limber pose", {".json"}}},
                       "-pose"}),
      export_operator({"file.export_motion",
                       "Motion...",
                       "Export the active motion as BVH.",
                       ExportKind::Motion,
                       {{"BVH", {".bvh"}}},
                       // The suffix keeps the export from overwriting the imported BVH file, which has the clip's name.
                       "-motion"}),
      export_operator({"file.export_gltf",
                       "glTF...",
                       "Export the surface, rig, weights and every clip for other programs.",
                       ExportKind::Gltf,
                       {{"glTF", {".glb"}}},
                       ""}),
      {"file.export", "Export...", icon::kExport, "Result",
       "Export the selected result as voxels, as surfaces, or as input for openEMS, gprMax and others.",
       [](Context& c) {
         browse_for_result(c, "Export " + chosen_result(c)->name, "export", file_name_of(c, *chosen_result(c)),
                           formats_of(*chosen_result(c)), export_result);
       },
       needs_result},
      {"file.export_image", "Posed image...", icon::kExport, "Export",
       "Export the grey image (CT, MR) that was posed together with the selected result.",
       [](Context& c) {
         browse_for_result(c, "Export posed image", "posed image", stem_of(c) + "-image", writable_volumes(),
                           export_posed_image);
       },
       needs_posed_image},
      {"report.open", "Report...", icon::kReport, "Result",
       "Export a web page of all results with pictures and quality gates and open it, or export the selected result's "
       "report as text or JSON.",
       [](Context& c) {
         browse_for_result(c, "Report", "report", stem_of(c) + "-results",
                           {{"Web page of all results", {".html"}}, {"Text", {".txt"}}, {"JSON", {".json"}}},
                           export_report);
       },
       needs_result},
      picture_operator("view.screenshot", "Picture...", "Export the active view as a PNG picture.", stem_of,
                       {{"PNG pictures", {".png"}}}, export_picture),
      {"file.export_figure", "Figure...", icon::kCamera, "Export",
       "Export the active view for a publication: its size in mm, with a scale bar, a legend and a title, as PNG, TIFF "
       "or SVG.",
       [last = std::make_shared<FigureOptions>()](Context& c) { ask_for_figure(c.dialogs, last); }, needs_volume},
      picture_operator(
          "view.turntable", "Turntable...",
          "Export 36 pictures of the body, with the camera turning once around it, or a video of 5 s.",
          [](const Context& c) { return stem_of(c) + "-turn"; },
          {{"PNG pictures", {".png"}}, {"MP4 video", {".mp4"}}, {"WebM video", {".webm"}}},
          [](Context& c, const Path& path) { export_turntable(c, path); }),
      motion_pictures(),
  };
}

}  // namespace limber::editor
