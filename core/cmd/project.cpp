// SPDX-License-Identifier: AGPL-3.0-or-later
// limber project NAME.limber [inspect] [--json]: prints what the project contains.
// limber project NAME.limber create [VOLUME] [--tissues T] [--rig R] [--weights W] [--pose P | --pose-name NAME]
//   [--joint "J M=DEG"] [--motion F.bvh [--up y|z|auto]] [--seams S.nrrd] [--bone-map M.json]: writes a new project.
// limber project NAME.limber verify: checks every byte; the exit code is 1 when something is wrong.
// limber project NAME.limber recover [FILE] -o OUT.limber: writes a project with the unsaved edits that a crash left.
//   It keeps the undamaged parts of a damaged project and takes lost parts from FILE: an earlier copy, or the volume
//   that the project was made from.
// limber project NAME.limber export PART -o OUT: writes one part. PART is volume, tissues, rig, weights, pose, motion,
//   gltf, seams, bone-map, or the name of a result. A motion with keys or constraints is written as it plays on the
//   rig, and --frame writes the pose of one of its frames.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <unordered_map>

#include "core/base/error.h"
#include "core/bones/bone_map.h"
#include "core/cmd/command.h"
#include "core/cmd/command_files.h"
#include "core/cmd/info_project.h"
#include "core/cmd/pose_options.h"
#include "core/export/gltf.h"
#include "core/motion/played_motion.h"
#include "core/pose/pose_io.h"
#include "core/project/carved_project.h"
#include "core/project/database.h"
#include "core/project/journal.h"
#include "core/project/project_io.h"
#include "core/rig_io/rig_io.h"
#include "core/seams/seams_io.h"
#include "core/skin/weights_io.h"
#include "core/volume_io/grey_image.h"

namespace limber::cmd {

namespace {

constexpr int kFarthestFrame = 1 << 28;  // larger frame numbers are refused: a project cannot store them

struct ProjectOptions {
  std::string file, action = "inspect", part;
  std::string tissues, rig, weights, pose, motion, seams, bone_map, output, progress, up = "y";
  PoseRequest body;  // values of --pose-name and --joint
  std::optional<int> frame;
  bool json = false, replace = false;
};

template <class T>
std::shared_ptr<const T> shared(T value) {
  return std::make_shared<const T>(std::move(value));
}

void require(bool holds, const std::string& what, const std::string& where, const std::string& what_to_do) {
  if (!holds) throw Error(what, where, what_to_do);
}

void require_new(const Path& path, bool replace) {
  check_place(path);
  std::error_code unreadable;
  require(replace || !std::filesystem::exists(path, unreadable), "a file of this name exists already", path.string(),
          "use another name, or add --replace");
}

// ---- limber project NAME.limber create

void read_body_parts(const ProjectOptions& options, Document& document, Progress& progress) {
  VolumeFile file = read_volume(options.part, progress);
  warn(file.warnings);
  std::optional<TissueTable> user;
  if (!options.tissues.empty()) user = read_tissue_table(options.tissues);
  document.tissues = shared(merge_tissue_tables(file.tissues, user ? &*user : nullptr));
  require_labels(file.volume, *document.tissues, options.part);
  document.volume_type = shared(std::move(file.type));
  document.volume = shared(std::move(file.volume));
}

Document read_parts(const ProjectOptions& options, Progress& progress) {
  Document document;
  require(options.part.empty() ? options.tissues.empty() && options.weights.empty() : true,
          "tissues and weights need a volume", options.file, "name the volume's file after create");
  require(options.rig.empty() ? options.weights.empty() && options.pose.empty() && options.body.empty() : true,
          "weights and poses need a rig", options.file, "name the rig with --rig");
  require(options.part.empty() ? options.seams.empty() && options.bone_map.empty() : true,
          "seams and bone maps need a volume", options.file, "name the volume's file after create");
  require(options.rig.empty() ? options.bone_map.empty() : true, "a bone map needs a rig", options.file,
          "name the rig with --rig");
  if (!options.part.empty()) read_body_parts(options, document, progress);
  if (!options.rig.empty()) {
    ArmatureFile rig = read_armature_file(options.rig);
    warn(rig.warnings);
    document.armature = shared(std::move(rig.armature));
    const Pose pose =
        options.pose.empty() ? rest_pose(*document.armature) : read_pose(options.pose, *document.armature);
    std::vector<std::string> warnings;
    document.pose = shared(with_request(*document.armature, pose, options.body, warnings));
    warn(warnings);
  }
  if (!options.weights.empty()) {
    WeightsFile weights =
        read_weights(options.weights, *document.volume, TissueVoxels(*document.volume), *document.armature);
    warn(weights.warnings);
    document.weights = shared(std::move(weights.weights));
  }
  if (!options.seams.empty()) document.seams = shared(read_seams(options.seams, *document.volume, progress));
  if (!options.bone_map.empty()) {
    document.bone_map = shared(read_bone_map(options.bone_map));
    // Throws Error for an unknown label or bone.
    bones_of_labels(*document.tissues, *document.armature, *document.bone_map);
  }
  if (!options.motion.empty()) {
    const auto motion = shared(read_motion(options.motion, options.up));
    document.clips.push_back(shared(clip_of(motion, std::filesystem::path(options.motion).stem().string())));
  }
  return document;
}

void create(const ProjectOptions& options) {
  require_new(options.file, options.replace);
  CommandProgress progress(options.progress);
  DocumentWriter writer;
  create_project({.document = read_parts(options, progress)}, options.file, writer, progress);
}

// ---- limber project NAME.limber verify, and recover

void verify(const ProjectOptions& options) {
  CommandProgress progress(options.progress);
  const auto wrong = verify_project(options.file, progress);
  for (const std::string& line : wrong) warn(line);
  require(wrong.empty(), "the project is damaged", options.file,
          "open an earlier copy, or recover the undamaged parts: limber project " + options.file +
              " recover -o OUT.limber");
  print("%s is undamaged\n", options.file.c_str());
}

// The chunks (stored pieces) of a document, held in memory.
class DocumentChunks final : public ChunkSource, public ChunkSink {
 public:
  explicit DocumentChunks(const Document& document) { DocumentWriter().write(document, *this, Packing::Quick); }
  bool has(const ChunkHash& hash) override { return chunks_.contains(hash); }
  void put(const ChunkHash& hash, const std::string& packed) override { chunks_.emplace(hash, packed); }
  std::optional<std::string> find(const ChunkHash& hash) override {
    const auto at = chunks_.find(hash);
    return at == chunks_.end() ? std::nullopt : std::optional(at->second);
  }

 private:
  std::unordered_map<ChunkHash, std::string, ChunkHash::Hasher> chunks_;
};

// Adds the file FILE of the command line as a source of lost chunks. FILE is another copy of the project, damaged or
// not, or the volume from which the project was made.
void add_help(CarvedChunks& chunks, const ProjectOptions& options, Progress& progress) {
  if (options.part.empty()) return;
  if (is_project(options.part)) {
    chunks.add(std::make_unique<CarvedChunks>(options.part, progress));
    return;
  }
  Document document;
  read_body_parts(options, document, progress);
  chunks.add(std::make_unique<DocumentChunks>(document));
}

// Reads the project. If it is damaged, rebuilds it from its undamaged chunks and stores these in `chunks`, which must
// then outlive the returned project.
Project read_or_carve(const ProjectOptions& options, std::unique_ptr<CarvedChunks>& chunks, Progress& progress) {
  std::string failure;
  try {
    Project project = read_project(options.file, progress);
    print("no unsaved edits were found; the project is written as it was saved\n");
    return project;
  } catch (const ProjectInUse&) {
    throw;
  } catch (const Error& error) {
    failure = error.what();
  }
  std::error_code error;
  require(std::filesystem::is_regular_file(options.file, error), "the project does not exist", options.file,
          "check the name");
  chunks = std::make_unique<CarvedChunks>(options.file, progress);
  require(!chunks->latest_first().empty(), "no part of a project was found", options.file,
          "name a .limber file, or open an earlier copy");
  warn(failure);
  add_help(*chunks, options, progress);
  Project project = put_together(*chunks, options.file, progress);
  print("%zu chunks of the damaged project are undamaged; their contents are kept\n", chunks->latest_first().size());
  return project;
}

void recover(const ProjectOptions& options) {
  require(!options.output.empty(), "recover needs a file to write", options.file, "name the file with -o OUT.limber");
  require_new(options.output, options.replace);
  CommandProgress progress(options.progress);
  Project project;
  std::unique_ptr<CarvedChunks> chunks;
  auto left = recoverable(options.file);  // options.file may itself be a journal
  if (!left) left = recoverable(journal_path(std::filesystem::absolute(options.file)));
  if (left) {
    Recovered recovered = limber::recover(left->journal, progress);
    warn(recovered.warnings);
    project.document = std::move(recovered.document);
    print("edits recovered up to: %s\n", one_line(recovered.label).c_str());
  } else {
    project = read_or_carve(options, chunks, progress);
    warn(project.warnings);
  }
  DocumentWriter writer;
  // Undamaged chunks that no part of the document uses are written too. Such chunks are kept until the new file is
  // saved again.
  create_project(project, options.output, writer, progress,
                 chunks ? SpareChunks{chunks->latest_first(), chunks.get()} : SpareChunks{});
}

// ---- limber project NAME.limber export

template <class T>
const T& there(const std::shared_ptr<const T>& part, const ProjectOptions& options) {
  require(part != nullptr, "the project has no such part", options.file + ", " + options.part,
          "list its contents: limber project " + options.file);
  return *part;
}

// Returns the shown clip's motion. A clip with keys, constraints or strips is written as it plays on the rig.
Motion motion_in(const Document& document, const ProjectOptions& options) {
  const Clip* clip = document.shown_clip();
  if (document.armature && clip && (!clip->keys.empty() || clip->constraints || clip->strips))
    return played_motion(document.clips[static_cast<std::size_t>(document.clip)], document.armature);
  return there(document.shown_clip() ? document.shown_clip()->motion : nullptr, options);
}

// Returns the pose that the project stores, or that of a frame of the shown clip, as the editor shows it.
Pose pose_in(const Document& document, const ProjectOptions& options) {
  if (!options.frame) return there(document.pose, options);
  require(document.armature && !document.clips.empty(), "the project has no clip on a rig", options.file,
          "leave --frame out");
  const ClipOnRig clip(document.clips[static_cast<std::size_t>(document.clip)], document.armature);
  require(clip.problem().empty(), "the clip does not move this rig", clip.clip()->name, clip.problem());
  return clip.at(*options.frame);
}

const LabelVolume& result_named(const Document& document, const ProjectOptions& options) {
  for (const auto& result : document.results)
    if (result->name == options.part && result->volume) return *result->volume;
  throw Error(
      "the project has no such part or result", options.file + ", " + options.part,
      "name volume, tissues, rig, weights, pose, motion, gltf, seams, bone-map, or a result that limber project " +
          options.file + " lists");
}

void export_part(const ProjectOptions& options) {
  require(!options.part.empty() && !options.output.empty(), "export needs a part and a file to write", options.file,
          "as in: export volume -o volume.nrrd");
  check_place(options.output);
  CommandProgress progress(options.progress);
  const Project project = read_project(options.file, progress);
  warn(project.warnings);
  const Document& document = project.document;
  const TissueTable tissues = document.tissues ? *document.tissues : TissueTable{};
  const FileType type = document.volume_type ? *document.volume_type : FileType{};
  if (options.part == "volume") write_volume(there(document.volume, options), options.output, tissues, type);
  else if (options.part == "tissues") write_tissue_table(there(document.tissues, options), options.output);
  else if (options.part == "rig") write_armature(there(document.armature, options), options.output);
  else if (options.part == "weights")
    write_weights(there(document.weights, options), *document.volume, TissueVoxels(*document.volume), options.output);
  else if (options.part == "pose") write_pose(pose_in(document, options), *document.armature, options.output);
  else if (options.part == "motion") write_bvh(motion_in(document, options), options.output);
  else if (options.part == "seams") write_seams(there(document.seams, options), document.volume->grid, options.output);
  else if (options.part == "bone-map") write_bone_map(there(document.bone_map, options), options.output);
  else if (options.part == "gltf")
    write_glb(
        {there(document.volume, options), tissues, there(document.armature, options), there(document.weights, options)},
        document.clips, options.output, {}, progress);
  else write_volume(result_named(document, options), options.output, tissues, type);
}

void run_project(const ProjectOptions& options) {
  require(!options.frame || (options.action == "export" && options.part == "pose"), "only export pose takes a frame",
          options.file, "leave --frame out");
  if (options.action == "create") return create(options);
  if (options.action == "verify") return verify(options);
  if (options.action == "recover") return recover(options);
  if (options.action == "export") return export_part(options);
  print_description(describe_project(options.file), options.json);
}

}  // namespace

void add_project(CLI::App& app) {
  auto* command =
      app.add_subcommand("project", "creates, inspects, verifies or recovers a project file, or exports its parts");
  auto options = std::make_shared<ProjectOptions>();
  writes(command->add_option("NAME", options->file, "NAME.limber"), [options](const std::string& name) {
    return options->action == "create" ? OptionFiles{{}, {name}} : OptionFiles{{name}, {}};
  })->required();
  command->add_option("ACTION", options->action, "inspect (default), create, verify, recover or export")
      ->check(CLI::IsMember({"inspect", "info", "create", "verify", "recover", "export"}));
  command->add_option(
      "PART", options->part,
      "for create: a label volume; for recover: an earlier copy of the project, or its original volume, from which "
      "lost parts are taken; for export: the part to write: volume, tissues, rig, weights, pose, motion, gltf, seams, "
      "bone-map, or a result's name");
  command->add_flag("--json", options->json, "only for inspect: print as JSON");
  command->add_option("--tissues", options->tissues, "only for create: tissue table (JSON, .ctbl, ITK-SNAP)");
  command->add_option("--rig", options->rig, "only for create: rig file");
  command->add_option("--weights", options->weights,
                      "only for create: weights, W.nrrd, or a folder with Bender's weights");
  add_body_pose_options(
      *command, options->body,
      command->add_option("--pose", options->pose, "only for create: pose file (JSON) (default: the rest pose)"));
  add_up_option(*command, options->up,
                command->add_option("--motion", options->motion, "only for create: motion file (BVH)"));
  command->add_option(
      "--seams", options->seams,
      "only for create: file of seams, where tissue touches without being connected, from 'limber prepare --seams'");
  command->add_option("--bone-map", options->bone_map,
                      "only for create: JSON file that says which rig bone each bone label follows");
  writes(command->add_option("-o,--output", options->output, "only for recover and export: the file to write"));
  command
      ->add_option(
          "--frame", options->frame,
          "only for export pose: frame of the shown clip to export, with keys and constraints (default: the project's "
          "pose)")
      ->check(CLI::Range(-kFarthestFrame, kFarthestFrame));
  command->add_flag("--replace", options->replace, "only for create and recover: overwrite an existing file");
  command
      ->add_option("--progress", options->progress,
                   "with the value json: print progress to stderr, one line of JSON per step (default: a progress bar)")
      ->check(CLI::IsMember({"json"}));
  command->callback([options] { run_project(*options); });
}

}  // namespace limber::cmd
