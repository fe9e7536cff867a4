// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/resample/resample_job.h"

#include "core/project/worker.h"
#include "core/resample/fem_steps.h"
#include "core/resample/pose_path.h"
#include "core/study/text.h"
#include "core/volume_io/volume_io.h"
#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/context/preferences.h"
#include "editor/context/resampling_settings.h"
#include "editor/file_browser/temp_folder.h"
#include "editor/resample/resample_inputs.h"
#include "editor/resample/results.h"
#include "editor/shown/fem_live_view.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"
#include "editor/volume/shown_image.h"
#include "editor/volume/tissue_edits.h"

namespace limber::editor {

namespace {

struct Request {
  Document from;  // the document to resample; has a pose
  ResamplingSettings settings;
  Path image;  // the shown grey image, to pose with the volume; empty: no image is shown
  std::string scratch;
  WorkerSettings worker;
  std::shared_ptr<SolveFeed> feed;  // passes the steps of a FEM solve to the views; null: no FEM
};

constexpr char kImage[] = "image.nrrd";
constexpr char kSteps[] = "solve";  // base name of the files that the solver writes after each of its steps

void write_inputs(const Request& request, const ScratchFolder& folder, Progress& progress) {
  write_body(request.from, folder, progress);
  PoseFiles files{.report = "report.json", .steps = kSteps, .image = request.image};
  if (!request.image.empty()) files.posed_image = folder / kImage;
  write_job(request.from, *request.from.pose, request.settings, files, folder);
}

std::shared_ptr<const Overlap> read_overlap(const Path& path, Progress& progress) {
  const VolumeFile file = read_volume(path, progress);
  auto overlap = std::make_shared<Overlap>();
  for (const Tissue& value : file.tissues.tissues) {
    auto& voxels = value.file_value == 1 ? overlap->tissue : overlap->bones;
    for (std::size_t i = 0; i < file.volume.voxels.size(); ++i)
      if (file.volume.voxels[i] == value.label) voxels.push_back(static_cast<std::int64_t>(i));
  }
  return overlap;
}

// Reads the files that the worker process writes during the solve, and passes each step to the SolveFeed.
class StepReader {
 public:
  StepReader(Path name, std::shared_ptr<SolveFeed> feed) : name_(std::move(name)), feed_(std::move(feed)) {}
  void operator()(const WorkerProgress& progress) {
    feed_->tell(progress);
    if (!progress.iteration) return;
    if (!rest_) read_rest();
    auto step = read_fem_step(name_);
    if (rest_ && step && step->V.rows() == rest_->tets.V.rows()) feed_->show(rest_, std::move(*step));
  }

 private:
  void read_rest() {
    if (auto mesh = read_fem_mesh(name_)) rest_ = std::make_shared<const FemMesh>(std::move(*mesh));
  }
  Path name_;
  std::shared_ptr<SolveFeed> feed_;
  std::shared_ptr<const FemMesh> rest_;
};

// Reads the solved FEM mesh. Returns null if the pose bends no joint, because no mesh is solved in this case.
std::shared_ptr<const SolvedMesh> read_solved(const Path& name) {
  auto mesh = read_fem_mesh(name);
  auto step = read_fem_step(name);
  if (!mesh || !step || mesh->tets.V.rows() != step->V.rows()) return nullptr;
  return std::make_shared<const SolvedMesh>(SolvedMesh{std::move(*mesh), std::move(step->V)});
}

// Reads the posed grey image. Moves its file into a folder that is not deleted when the job ends.
PosedImage read_posed_image(const Request& request, const ScratchFolder& folder, Progress& progress) {
  PosedImage image;
  const auto kept = std::make_shared<const ScratchFolder>(request.scratch);
  image.file = *kept / kImage;
  std::filesystem::rename(folder / kImage, image.file);
  image.folder = kept;
  image.levels = levels_of(read_grey_volume(image.file, progress));
  return image;
}

// What a resampling job returns in addition to its edit of the document.
struct Made {
  std::string name;  // name of the result
  PosedImage image;
  std::string image_problem;  // why the posed image is missing; "": it was made, or none was requested
};

Edit resample_in_worker(Request& request, const std::shared_ptr<Made>& made, Progress& progress) {
  const ScratchFolder folder(request.scratch);
  write_inputs(request, folder, progress);
  if (request.feed) request.worker.on_progress = StepReader(folder / kSteps, request.feed);
  run_worker(folder / "job.json", progress, request.worker);
  auto result = std::make_shared<Result>();
  const ResamplingSettings& settings = request.settings;
  result->method = settings.method + (settings.method == kFiniteElements && settings.contact ? "-contact" : "");
  result->volume = read_posed(folder / "posed.nrrd", *request.from.tissues, progress);
  result->overlap = read_overlap(folder / "overlap.nrrd", progress);
  result->report = read_file(folder / "report.json");
  if (!request.image.empty()) try {
      made->image = read_posed_image(request, folder, progress);
      made->image.result = result->volume;
    } catch (const Cancelled&) {
      throw;
    } catch (const std::exception& error) {
      made->image_problem = error.what();  // the job continues: the posed volume is valid without the posed image
    }
  result->from_volume = request.from.volume;
  result->from_tissues = request.from.tissues;
  result->from_armature = request.from.armature;
  result->from_weights = request.from.weights;
  result->from_pose = request.from.pose;
  result->from_seams = request.from.seams;
  result->from_bone_map = request.from.bone_map;
  if (request.feed) result->solved = read_solved(folder / kSteps);
  const std::string wanted = name_of_pose(*request.from.armature, *request.from.pose) + ", " +
                             method_name(result->method) + (settings.mass_exact ? ", mass-exact" : "");
  return [result, wanted, made](const Document& now) {
    Document next = now;
    result->name = made->name = unique_name(now.results, wanted);
    next.results.push_back(result);
    return next;
  };
}

void tell(Context& context, const std::string& name) {
  for (const auto& result : context.document().results) {
    if (result->name != name) continue;
    const auto facts = facts_of(context, result);
    char line[64], detail[96];
    std::snprintf(line, sizeof line, "resampled in %.1f s", facts->seconds);
    if (facts->change_percent)
      std::snprintf(detail, sizeof detail, "volume %+.2f %%, %s overlap voxels", *facts->change_percent,
                    grouped(facts->overlap_voxels).c_str());
    else std::snprintf(detail, sizeof detail, "%s overlap voxels", grouped(facts->overlap_voxels).c_str());
    context.messages->ok(name + " " + line, detail, "result.show_last");
    for (const std::string& warning : facts->warnings) context.messages->warn(name, capitalized(warning));
  }
}

}  // namespace

std::string why_no_resampling(const Context& context) {
  const Document& document = context.document();
  if (!document.volume || !document.tissues) return "Open a volume first";
  if (!document.armature) return "Import a rig first";
  if (!document.weights) return "Compute the weights first";
  if (document.weights->bones().size() != document.armature->bones.size())
    return "The weights belong to another rig: compute them again";
  return "";
}

void start_resampling(Context& context) {
  Request request{context.document(),
                  context.resampling,
                  context.views->image ? context.views->image_path : Path(),
                  context.preferences->scratch_folder,
                  {},
                  {}};
  if (!request.from.pose) request.from.pose = std::make_shared<const Pose>(rest_pose(*request.from.armature));
  if (request.settings.method == kFiniteElements) request.feed = std::make_shared<SolveFeed>();
  request.worker.program = context.background->worker_program;
  request.worker.yields = context.background->workers_yield;
  request.worker.memory_limit_mb = context.preferences->worker_memory_mb;
  request.worker.time_limit = context.preferences->worker_minutes * 60.0;
  const auto made = std::make_shared<Made>();
  const std::string label = "Resample " + name_of_pose(*request.from.armature, *request.from.pose);
  const int id = context.jobs->start(
      label, [request, made](Progress& progress) mutable { return resample_in_worker(request, made, progress); },
      request.feed ? Lane::Long : Lane::Common);
  context.background->step_of_job[id] = StepOfWork::Resample;
  if (request.feed) {
    context.fem->solves[id] = {request.from, largest_angle_degrees(*request.from.pose), request.feed};
    watch(context);
  }
  context.background->after_job[id] = [made](Context& c, const JobStatus& job) {
    const bool was_watched = c.fem->watched == job.id;
    c.fem->solves.erase(job.id);
    if (was_watched) stop_watching(c.fem);
    if (job.state != JobState::Done) return;
    if (!made->image_problem.empty()) c.messages->warn("The posed image is not shown", made->image_problem);
    if (made->image.levels) keep_posed_image(*c.views, std::move(made->image));
    tell(c, made->name);
    if (was_watched && c.workspace() == Workspace::Resample) show_result(c, made->name);
  };
  context.ui->touch();
}

}  // namespace limber::editor
