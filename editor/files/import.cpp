// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/files/import.h"

#include <algorithm>
#include <ctime>

#include "core/autorig/rig_check.h"
#include "core/base/error.h"
#include "core/motion/bvh.h"
#include "core/motion/motion_edit.h"
#include "core/motion/up_axis.h"
#include "core/phantom/phantom.h"
#include "core/pose/pose_io.h"
#include "core/rig_io/rig_io.h"
#include "core/skin/weights_io.h"
#include "core/volume_io/dicom.h"
#include "core/volume_io/grey_image.h"
#include "core/volume_io/volume_files.h"
#include "core/volume_io/volume_io.h"
#include "editor/context/arriving_body.h"
#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/context/document_edits.h"
#include "editor/context/open_project.h"
#include "editor/context/operator.h"
#include "editor/context/recent_files.h"
#include "editor/context/selection.h"
#include "editor/context/tissue_bounds.h"
#include "editor/file_browser/thumbnails.h"
#include "editor/files/project_session.h"
#include "editor/motion/motion_clip_edits.h"
#include "editor/motion/timeline.h"
#include "editor/pose/pose_edits.h"
#include "editor/rig/auto_rig.h"
#include "editor/rig/rig_edits.h"
#include "editor/shown/frame_all.h"
#include "editor/skin/weight_layers.h"
#include "editor/ui/messages.h"
#include "editor/volume/grey_image_panel.h"
#include "editor/volume/image_labels.h"
#include "editor/volume/shown_image.h"

namespace limber::editor {

namespace fs = std::filesystem;

namespace {

// Returns a volume file's name without its extension, which may have two parts (".nii.gz", ".seg.nrrd").
std::string name_of_file(const Path& path) {
  const Path stem = path.stem();
  const bool has_two = stem.extension() == ".nii" || stem.extension() == ".seg";
  return (has_two && !stem.stem().empty() ? stem.stem() : stem).string();
}

template <class T>
std::shared_ptr<const T> shared(T value) {
  return std::make_shared<const T>(std::move(value));
}

std::string imported(const Path& path) { return "Import " + path.filename().string(); }

void warn_of(Messages& messages, const Path& path, const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) messages.warn(path.filename().string(), warning);
}

// Returns a new document with the file's tissues and volume type. The new document has no rig and no weights, because
// the rig and weights of the open document were made for another volume.
Document with_volume(const VolumeFile& file) {
  Document document;
  document.tissues = shared(merge_tissue_tables(file.tissues, nullptr));
  document.volume_type = shared(file.type);
  return document;
}

[[noreturn]] void refuse(const std::string& what, const Path& path, const std::string& what_to_do) {
  throw Error(what, path.string(), what_to_do);
}

std::string name_of(FileKind kind) {
  switch (kind) {
    case FileKind::Project: return "the project";
    case FileKind::Volume: return "the volume";
    case FileKind::Tissues: return "the tissues";
    case FileKind::Rig: return "the rig";
    case FileKind::Weights: return "the weights";
    case FileKind::Motion: return "the motion";
    case FileKind::Pose: return "the pose";
  }
  return "";
}

// Returns the file itself and, for a volume, the other files that are read with it.
std::vector<NamedFile> inputs_of(FileKind kind, const Path& path) {
  std::vector<NamedFile> inputs;
  for (const Path& file : kind == FileKind::Volume ? files_of_volume(path) : std::vector<Path>{path})
    inputs.push_back({name_of(kind), file});
  return inputs;
}

// ---- Reading files in background tasks. A task uses a copy of the document that was made when the task began

// The content of a volume file: labels, a grey image, or both. A file is read as both if its values are whole numbers,
// which may be labels, but are distributed like grey values.
struct ReadVolume {
  std::optional<VolumeFile> labels;
  std::shared_ptr<const GreyVolume> image;  // kept only while the user may still decide that the file holds labels
  std::optional<render::ShownGrey> shown;   // the image as it will be shown; empty: there is no image
  std::string doubt;                        // why the file seems to be a grey image; "": it is a label volume
  bool is_image = false;                    // true: the file is certainly a grey image
  std::shared_ptr<Opened> as_project;       // project that shows the image without labels; null: there is no image
};

bool has_tissues(const Document& document) { return document.tissues && !document.tissues->tissues.empty(); }

// Returns a project for an image without labels that was read from `path`. The caller sets the project's members
// `agreed` and `then`.
std::shared_ptr<Opened> project_for_image(const GreyLevels& image, const Path& path) {
  auto opened = std::make_shared<Opened>();
  opened->document = document_for_image(image);
  opened->extents = shared(extents_of(opened->document.volume));
  opened->inputs = inputs_of(FileKind::Volume, path);
  opened->name = name_of_file(path);
  opened->label = "Open image " + path.filename().string();
  return opened;
}

ReadVolume read_labels_or_image(const Path& path, Progress& progress) {
  ReadVolume read;
  try {
    read.labels = read_volume(path, progress);
  } catch (const Error&) {
    if (summarize_volume(path).is_label) throw;
    read.doubt = "its values are not whole numbers, or exceed 65 535";
  }
  if (read.labels)
    if (const auto doubt = grey_image_doubt(read.labels->volume, read.labels->tissues)) read.doubt = *doubt;
  constexpr double kAirOfCt = -100;  // a value below this is Hounsfield units of air or fat, and no label
  if (read.labels && read.doubt.empty())
    for (const Tissue& tissue : read.labels->tissues.tissues)
      if (tissue.file_value < kAirOfCt) read.doubt = "it has negative values, as a CT has";
  if (read.doubt.empty()) return read;
  read.image = shared(read_grey_volume(path, progress));
  read.shown = usually_shown(levels_of(*read.image));
  // Labels are not negative. A DICOM series whose values look like grey values is an image from a scanner.
  read.is_image = !read.labels || read.shown->image->least < 0 || read.image->type.format == "DICOM";
  // The editor's own thread would need many milliseconds to free so much memory.
  if (read.is_image) read.labels.reset(), read.image.reset();
  read.as_project = project_for_image(*read.shown->image, path);
  return read;
}

// Makes the views ready to show the image, with the body that is open or, without one, alone.
void make_image_ready(const MakeReady& make_ready, const Document& now, const Opened& opened,
                      const render::ShownGrey& shown, Progress& progress) {
  make_ready(has_tissues(now) ? now : opened.document, progress, shown);
}

// Shows an image that was read from `path` with the open body. If no body is open, opens the project `opened` for the
// image.
//   agreed  revision of the open project that the user agreed to replace; -1: the user was not asked
void take_image(Context& context, const render::ShownGrey& image, const std::shared_ptr<Opened>& opened,
                const Path& path, std::int64_t agreed) {
  if (has_tissues(context.document())) {
    show_image(context, image, path);
    context.messages->ok(path.filename().string(),
                         "The image is shown with the body. Its settings are in Sidebar > Image.");
    return;
  }
  opened->then = [image, path](Context& c) {
    show_image(c, image, path);
    c.views->display = render::Display::Image;
    c.messages->ok(path.filename().string(),
                   "This is a grey image. To rig it, make labels first: Edit > Prepare volume > " +
                       find_operator(c.operators, labels_operator(c.views))->label);
  };
  opened->agreed = agreed;
  add_recent(context.recent_files, path, std::time(nullptr));
  replace_project(context, opened);
}

// Opens a label volume by calling `take`. A grey image is shown with the body instead. If the file may be either, first
// shows the image in a dialog, and calls `take` only if the user agrees to open the image as labels.
//   agreed  revision of the open project that the user agreed to replace; -1: the user was not asked
void take_or_show(Context& context, const ReadVolume& read, const Path& path, const char* answer, const Finish& take,
                  std::int64_t agreed) {
  if (!read.shown) return take(context);
  const Finish show = [shown = *read.shown, opened = read.as_project, path, agreed](Context& c) {
    take_image(c, shown, opened, path, agreed);
  };
  if (read.is_image) return show(context);
  show_grey_image(context, {.image = read.image,
                            .name = path.filename().string(),
                            .doubt = read.doubt,
                            .answer = answer,
                            .as_labels = take,
                            .as_image = show});
}

using Change = std::function<void(Document&)>;
struct Import {
  Change change;
  std::vector<std::string> warnings;
  double inside = 1;     // for a rig: fraction of the total bone length that is inside tissue
  ReadVolume read = {};  // for a volume: the file's content
  std::vector<NamedFile> inputs = {};
};

Import read_tissues(const Path& path, const Document& now) {
  if (!now.volume) refuse("a tissue table needs a volume", path, "open the tissue table's volume first");
  const TissueTable table = read_tissue_table(path);
  const bool any = std::any_of(table.tissues.begin(), table.tissues.end(),
                               [&](const Tissue& t) { return now.tissues->find_file_value(t.file_value); });
  if (!any) refuse("none of these tissues is in the volume", path, "select the table of this volume");
  auto merged = shared(merge_tissue_tables(*now.tissues, &table));
  return {[merged](Document& d) { d.tissues = merged; }};
}

// Smallest fraction of a rig's total bone length that lies inside tissue if the rig fits the body. Below this fraction
// the rig probably belongs to another body or uses another unit of length.
constexpr double kMisplaced = 0.5;

// Reads a rig. In BVH files the y axis normally points up. If the z axis points up in a file, its rig is rotated to
// stand upright.
ArmatureFile read_upright(const Path& path) {
  if (extension_of(path) != ".bvh") return read_armature_file(path);
  Motion motion = read_bvh(path);
  Motion rest = motion;
  rest.frame_count = 0;
  rest.values.clear();
  UpGuess up = up_axis_of(rest);
  if (up.by == UpGuess::By::Nothing) up = up_axis_of(motion);
  if (up.axis == UpAxis::Z) rest = y_up_from_z_up(rest);
  ArmatureFile file{armature_of(rest), "BVH", motion.warnings};
  if (up.axis == UpAxis::Z)
    file.warnings.push_back("The file's z axis points up (" + reason_of(up) + "), so it was turned upright.");
  return file;
}

Import read_rig(const Path& path, const Document& now) {
  ArmatureFile file = read_upright(path);
  const bool tissue = now.volume && std::any_of(now.volume->voxels.begin(), now.volume->voxels.end(),
                                                [](Label label) { return label != 0; });
  const double inside = tissue ? check_rig(*now.volume, file.armature).whole : 1;
  auto rig = shared(std::move(file.armature));
  return {[rig](Document& d) {
            d.armature = rig;
            d.weights.reset();
            d.layers.reset();
            d.pose = pose_at_frame(d);
          },
          file.warnings, inside};
}

Import read_weights_file(const Path& path, const Document& now) {
  if (!now.volume || !now.armature)
    refuse("weights need a volume and a rig", path, now.volume ? "import the rig first" : "open the volume first");
  WeightsFile file = read_weights(path, *now.volume, TissueVoxels(*now.volume), *now.armature);
  return {[weights = shared(std::move(file.weights))](Document& d) { set_weights(d, weights); }, file.warnings};
}

Import read_pose_file(const Path& path, const Document& now) {
  if (!now.armature) refuse("a pose needs a rig", path, "import the rig first");
  return {[pose = shared(read_pose(path, *now.armature))](Document& d) { d.pose = pose; }};
}

Import read_motion(const Path& path) {
  Motion read = read_bvh(path);
  if (read.frame_count == 0) refuse("this motion has no frames", path, "import it as a rig, or select another file");
  if (const UpGuess up = up_axis_of(read); up.axis == UpAxis::Z) {
    read = y_up_from_z_up(read);
    read.warnings.push_back("The file's z axis points up (" + reason_of(up) +
                            "), so it was turned upright. File > Import > Motion lets you select the axis.");
  }
  auto motion = shared(std::move(read));
  return {[motion, name = path.stem().string()](Document& d) { add_clip(d, clip_for(d, motion, name)); },
          motion->warnings};
}

Import read_import(FileKind kind, const Path& path, const Document& now, Progress& progress) {
  switch (kind) {
    case FileKind::Tissues: return read_tissues(path, now);
    case FileKind::Rig: return read_rig(path, now);
    case FileKind::Weights: return read_weights_file(path, now);
    case FileKind::Pose: return read_pose_file(path, now);
    case FileKind::Motion: return read_motion(path);
    case FileKind::Project: refuse("a project is opened, not imported", path, "use File > Open");
    case FileKind::Volume: break;
  }
  ReadVolume read = read_labels_or_image(path, progress);
  if (!read.labels) return {{}, {}, 1, std::move(read)};
  VolumeFile& file = *read.labels;
  Document replaced = with_volume(file);
  replaced.volume = shared(std::move(file.volume));
  return {[replaced](Document& d) {
            Document before = std::move(d);
            d = replaced;
            d.clips = std::move(before.clips);
            d.clip = before.clip;
            d.frame = before.frame;
          },
          file.warnings, 1, std::move(read)};
}

// Makes the views ready to show an imported volume or image.
void make_import_ready(const MakeReady& make_ready, const Document& before, const Import& import, Progress& progress) {
  const ReadVolume& read = import.read;
  if (read.is_image) return make_image_ready(make_ready, before, *read.as_project, *read.shown, progress);
  if (!import.change || !read.doubt.empty()) return;
  Document next = before;
  import.change(next);
  make_ready(next, progress, {});
}

// Returns true if the parts of the document that an import reads did not change during the import. `then` is the
// document at the start of the import, `now` the document at its end.
bool same_basis(FileKind kind, const Document& then, const Document& now) {
  if (kind == FileKind::Volume || kind == FileKind::Motion) return true;
  if (then.volume != now.volume) return false;
  return kind == FileKind::Tissues ? then.tissues == now.tissues
                                   : kind == FileKind::Rig || then.armature == now.armature;
}

// Opens the files one after another. The next file is opened when the document contains the file before it.
void open_in_order(Context& context, std::vector<std::pair<FileKind, Path>> files, Then then) {
  if (files.empty()) {
    if (then) then(context);
    return;
  }
  const auto [kind, path] = files.front();
  files.erase(files.begin());
  const Then next = [files, then](Context& c) { open_in_order(c, files, then); };
  if (kind == FileKind::Project) return open_project(context, path, next);
  if (kind == FileKind::Volume) return open_volume(context, path, next);
  import_file(context, kind, path, next);
}

StepOfWork step_of(FileKind kind) {
  switch (kind) {
    case FileKind::Rig: return StepOfWork::Rig;
    case FileKind::Weights: return StepOfWork::Skin;
    case FileKind::Pose:
    case FileKind::Motion: return StepOfWork::Pose;
    default: return StepOfWork::Prepare;
  }
}

}  // namespace

void open_files(Context& context, std::vector<Path> paths, Then then) {
  if (paths.empty()) return;
  const std::string label =
      "Open " + (paths.size() == 1 ? paths[0].filename().string() : std::to_string(paths.size()) + " files");
  start_task(context, label, [paths = std::move(paths), then](Progress& progress) -> Finish {
    std::vector<std::pair<FileKind, Path>> files;
    for (const Path& path : paths) {
      progress.update("files", static_cast<double>(files.size()) / static_cast<double>(paths.size()));
      files.emplace_back(kind_of(path), fs::absolute(path).lexically_normal());
    }
    std::stable_sort(files.begin(), files.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (std::size_t i = 1; i < files.size(); ++i)
      if (files[i].first <= FileKind::Volume)
        throw Error("only one volume or project can be opened at a time", files[i].second.string(),
                    "open one of these files");
    return [files, then](Context& c) { open_in_order(c, files, then); };
  });
}

void open_volume(Context& context, const Path& path, Then then) {
  ask_about_unsaved(context, [path, then](Context& c) {
    auto work = [path, then, now = c.document(), agreed = c.history->revision(),
                 make_ready = body_maker(*c.views)](Progress& progress) -> Finish {
      ReadVolume read = read_labels_or_image(path, progress);
      if (read.is_image) make_image_ready(make_ready, now, *read.as_project, *read.shown, progress);
      if (!read.labels) return [read, path, agreed](Context& c) { take_or_show(c, read, path, "", {}, agreed); };
      VolumeFile& file = *read.labels;
      auto opened = std::make_shared<Opened>();
      opened->document = with_volume(file);
      opened->document.volume = shared(std::move(file.volume));
      opened->extents = shared(extents_of(opened->document.volume));
      if (read.doubt.empty()) make_ready(opened->document, progress, {});
      opened->inputs = inputs_of(FileKind::Volume, path);
      opened->name = name_of_file(path);
      opened->label = "Open " + path.filename().string();
      opened->agreed = agreed;
      opened->then = [path, then](Context& c) {
        keep_thumbnail(c, path);
        if (then) then(c);
      };
      const Finish take = [opened, path, warnings = file.warnings](Context& c) {
        warn_of(c.messages, path, warnings);
        add_recent(c.recent_files, path, std::time(nullptr));
        replace_project(c, opened);
      };
      return [take, path, agreed, read = std::move(read)](Context& c) {
        take_or_show(c, read, path, "Open as labels", take, agreed);
      };
    };
    const int job = start_task(c, "Open " + path.filename().string(), std::move(work));
    c.background->step_of_job[job] = StepOfWork::Prepare;
  });
}

void import_file(Context& context, FileKind kind, const Path& path, Then then) {
  const int job = start_task(
      context, imported(path),
      [kind, path, then, before = context.document(),
       make_ready = body_maker(*context.views)](Progress& progress) -> Finish {
        auto import = std::make_shared<Import>(read_import(kind, path, before, progress));
        if (kind == FileKind::Volume) make_import_ready(make_ready, before, *import, progress);
        import->inputs = inputs_of(kind, path);
        const Finish take = [import, kind, path, then, before](Context& c) {
          if (!same_basis(kind, before, c.document()))
            refuse("the project changed while the file was read", path, "import it again");
          Document next = c.document();
          import->change(next);
          if (kind == FileKind::Pose)
            commit_pose(c, imported(path), pose_of(next), changed_bones(pose_of(c.document()), pose_of(next)));
          else commit(c, imported(path), std::move(next));
          c.project->inputs.insert(c.project->inputs.end(), import->inputs.begin(), import->inputs.end());
          warn_of(c.messages, path, import->warnings);
          if (kind == FileKind::Rig && before.armature) warn_of_moved_targets(c, imported(path), *before.armature);
          if (kind == FileKind::Volume) {
            *c.selection = {};
            frame_all(c, false);
          }
          if (then) then(c);
          if (import->inside < kMisplaced) offer_fit(c, path.filename().string(), import->inside);
        };
        return
            [import, path, take](Context& c) { take_or_show(c, import->read, path, "Replace the labels", take, -1); };
      });
  context.background->step_of_job[job] = step_of(kind);
}

void open_image(Context& context, const Path& path) {
  const int job = start_task(
      context, "Open image " + path.filename().string(),
      [path, now = context.document(), make_ready = body_maker(*context.views)](Progress& progress) -> Finish {
        const render::ShownGrey shown = usually_shown(levels_of(read_grey_volume(path, progress)));
        const auto opened = project_for_image(*shown.image, path);
        make_image_ready(make_ready, now, *opened, shown, progress);
        return [shown, opened, path](Context& c) { take_image(c, shown, opened, path, -1); };
      });
  context.background->step_of_job[job] = StepOfWork::Prepare;
}

const SampleFacts& facts_of(Sample sample) {
  static constexpr SampleFacts kFacts[] = {{"Arm", "2 mm \u00b7 skin, muscles, bones", "arm.png"},
                                           {"Arm, X-ray", "2 mm \u00b7 the bones inside", "arm_xray.png"},
                                           {"Body", "4 mm \u00b7 whole body", "body.png"},
                                           {"Body, opened", "4 mm \u00b7 organs", "body_open.png"}};
  return kFacts[static_cast<int>(sample)];
}

void open_sample(Context& context, Sample sample, Then then) {
  ask_about_unsaved(context, [sample, then](Context& c) {
    const SampleFacts& facts = facts_of(sample);
    const int job = start_task(c, "Make sample: " + std::string(facts.name),
                               [sample, then, &facts, agreed = c.history->revision(),
                                make_ready = body_maker(*c.views)](Progress& progress) -> Finish {
                                 const bool arm = sample == Sample::Arm || sample == Sample::ArmXray;
                                 Phantom phantom = arm ? make_arm_phantom(2, progress) : make_body_phantom(4, progress);
                                 auto opened = std::make_shared<Opened>();
                                 Document& document = opened->document;
                                 if (sample == Sample::BodyTissues) {
                                   Visibility visibility;
                                   for (const Tissue& tissue : phantom.tissues.tissues)
                                     if (tissue.kind == TissueKind::Skin || tissue.kind == TissueKind::Fat ||
                                         tissue.kind == TissueKind::Muscle)
                                       visibility.looks[tissue.label].visible = false;
                                   document.visibility = shared(std::move(visibility));
                                 }
                                 document.volume = shared(std::move(phantom.volume));
                                 opened->extents = shared(extents_of(document.volume));
                                 document.tissues = shared(std::move(phantom.tissues));
                                 make_ready(document, progress, {});
                                 document.volume_type = shared(FileType{"NRRD", "uint8", true});
                                 document.armature = shared(std::move(phantom.armature));
                                 add_clip(document, clip_of(shared(std::move(phantom.motion)), "Motion"));
                                 document.frame = 0;
                                 opened->name = std::string(facts.name);
                                 opened->label = "Open sample: " + opened->name;
                                 opened->agreed = agreed;
                                 opened->then = then;
                                 return [opened, sample](Context& c) {
                                   c.views->display =
                                       sample == Sample::ArmXray ? render::Display::XRay : render::Display::Solid;
                                   replace_project(c, opened);
                                 };
                               });
    c.background->step_of_job[job] = StepOfWork::Prepare;
  });
}

void open_waiting_files(Context& context) {
  if (!context.project->to_open.empty()) open_files(context, std::exchange(context.project->to_open, {}));
}

}  // namespace limber::editor
