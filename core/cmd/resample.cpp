// SPDX-License-Identifier: AGPL-3.0-or-later
// limber resample VOLUME --rig RIG [--tissues T] [--bones L,L] [--weights W] [--seams FILE|none] POSE-OPTIONS
//   [--method lbs|dqs|mix|fem] [--baked JOINT.bake]... [--glide off|voxel|joint|MM] [--fit-joints] [--contact]
//   [--quality draft|normal|fine]
//   [--mesher lattice|tetgen] [--obstacle SHAPE]... [--gravity X,Y,Z] [--pressure OUT.csv] [--mesh-out NAME
//   [--mesh-unit mm|cm]] [--steps NAME] -o OUT [--report R.json]
//   [--spacing MM] [--nearest] [--mass-exact [--mass-limit PERCENT]] [--with GREY=OUT2] [--landmarks IN.csv=OUT.csv]
//   [--field OUT.nrrd] [--jacobian OUT.nrrd] [--overlap OUT.nrrd] [--frames FIRST:LAST[:STEP]] [--strict]
//   [--threads N] [--progress json]: poses a label volume, or a sequence of frames.
#include "core/resample/resample.h"

#include <filesystem>
#include <memory>
#include <optional>

#include "core/bake/baked_joint_io.h"
#include "core/base/output_files.h"
#include "core/base/parallel.h"
#include "core/body/glide_poses.h"
#include "core/body/pose_body.h"
#include "core/cmd/body_options.h"
#include "core/cmd/command.h"
#include "core/cmd/command_files.h"
#include "core/cmd/companion.h"
#include "core/cmd/fem_options.h"
#include "core/cmd/frame_names.h"
#include "core/cmd/glide_options.h"
#include "core/cmd/mesh_options.h"
#include "core/cmd/pose_options.h"
#include "core/cmd/seam_options.h"
#include "core/deform/blend_rule.h"
#include "core/fem/solve_pose.h"
#include "core/motion/frame_range.h"
#include "core/report/report.h"
#include "core/resample/deformation_method.h"
#include "core/resample/fem_shape.h"
#include "core/resample/fem_steps.h"
#include "core/resample/pose_path.h"
#include "core/resample/posed_mesh.h"
#include "core/resample/posed_points.h"
#include "core/volume_io/landmarks.h"
#include "core/volume_io/vector_volume_io.h"
#include "core/volume_io/volume_files.h"

namespace limber::cmd {

namespace {

struct Resampling {
  BodyOptions body;
  PoseOptions pose;
  RunOptions run;
  std::string weights, method = deformation_methods().front().word, output, report, grey, field,
                       field_direction = kToPosed, jacobian, overlap, mesh_out, solver_mesh, landmarks, steps, seams,
                       glide;
  MeshOptions mesh;
  std::string frames;  // frames of the motion, FIRST:LAST[:STEP]
  std::optional<double> spacing;
  std::vector<std::string> baked;  // names of files of baked joints
  double mass_limit = ResampleSettings{}.mass_limit_percent;
  bool nearest = false, mass_exact = false, fit_joints = false, strict = false;
  std::shared_ptr<FemOptions> fem = std::make_shared<FemOptions>();
};

// Returns the options for one frame of a sequence, with the frame's number in the names of all output files.
Resampling of_frame(const Resampling& options, int frame) {
  Resampling one = options;
  one.pose.frame = frame;
  one.fem = std::make_shared<FemOptions>(*options.fem);
  for (std::string* output : {&one.output, &one.report, &one.grey, &one.field, &one.jacobian, &one.overlap,
                              &one.mesh_out, &one.solver_mesh, &one.landmarks, &one.fem->pressure})
    *output = cmd::of_frame(*output, frame);
  return one;
}

FilesOfValue files_of_mesh(const std::shared_ptr<Resampling>& options) {
  return [options](const std::string& value) {
    OptionFiles files;
    for (const std::string& name : names_of(value, options->frames))
      for (const Path& file : mesh_files(name)) files.written.push_back(file);
    return files;
  };
}

// Returns a function that lists the files that an output option writes: the option's value with each of `endings`, or,
// if `endings` is empty, the files of a volume.
FilesOfValue files_written_to(const std::shared_ptr<Resampling>& options,
                              const std::vector<const char*>& endings = {}) {
  return [options, endings](const std::string& value) {
    OptionFiles files;
    for (const std::string& name : names_of(value, options->frames)) {
      for (const char* ending : endings) files.written.emplace_back(name + ending);
      if (endings.empty())
        for (const Path& file : files_written_as(name)) files.written.push_back(file);
    }
    return files;
  };
}

// Returns a function that lists the files of an option with the value IN=OUT.
FilesOfValue files_of_pair(const std::shared_ptr<Resampling>& options) {
  return [options](const std::string& value) {
    const Companion pair = companion(value, "input", "IN=OUT");
    OptionFiles files{{pair.from}, {}};
    for (const std::string& name : names_of(pair.to, options->frames))
      for (const Path& file : files_written_as(name)) files.written.push_back(file);
    return files;
  };
}

// Checks that every output can be written, before any computation.
void check_outputs(const Resampling& options) {
  check_writable(options.output);
  std::vector<std::string> outputs = {options.output, options.field, options.jacobian, options.overlap};
  if (!options.grey.empty()) outputs.push_back(grey_paths(options.grey).to);
  for (const std::string& volume : outputs)
    if (!volume.empty()) check_writable(volume);
  std::vector<std::string> others = {options.report, options.fem->pressure};
  for (const std::string& mesh : {options.mesh_out, options.solver_mesh})
    if (!mesh.empty())
      for (const Path& file : mesh_files(mesh)) others.push_back(file.string());
  if (!options.landmarks.empty()) others.push_back(landmark_paths(options.landmarks).to);
  if (!options.steps.empty()) others.insert(others.end(), {options.steps + ".mesh", options.steps + ".step"});
  for (const std::string& other : others)
    if (!other.empty()) check_place(other);
}

// Prints the warnings at once and also adds them to the report.
void note(Report& report, const std::vector<std::string>& warnings) {
  warn(warnings);
  report.warnings.insert(report.warnings.end(), warnings.begin(), warnings.end());
}

void check_sequence(const Resampling& options) {
  if (options.frames.empty()) return;
  if (options.pose.motion.empty())
    throw Error("--frames needs a motion", "--frames " + options.frames, "add --motion F.bvh");
  if (options.pose.frame)
    throw Error("--frame and --frames exclude each other", "--frame " + std::to_string(*options.pose.frame),
                "leave out --frame or --frames");
  if (options.fit_joints)
    throw Error("joints are fitted to one pose, not to a sequence", "--fit-joints",
                "fit each joint first: limber fit-joint VOLUME --rig RIG --bone B -o RIG2");
  if (!options.steps.empty()) throw Error("--steps excludes --frames", "--steps " + options.steps, "leave out --steps");
  for (const std::string& output :
       {options.output, options.report, options.grey, options.field, options.jacobian, options.overlap,
        options.mesh_out, options.solver_mesh, options.landmarks, options.fem->pressure})
    if (!output.empty() && output.find(kFrame) == std::string::npos)
      throw Error("every frame would be written to the same file", output,
                  "put {frame} into its name, as in posed_{frame}.nrrd");
}

// Throws Error for options that need other options or exclude each other.
void check_method(const Resampling& options) {
  if (options.mass_exact && options.nearest)
    throw Error("--mass-exact needs interpolated labels, which --nearest does not compute", "--mass-exact",
                "leave out --mass-exact or --nearest");
  if (!options.baked.empty() && options.method != rule_of(Blend::DualQuaternion).word)
    throw Error("baked joints correct dual quaternions only", "--method " + options.method,
                "use --method dqs, or leave out --baked");
  if (!options.baked.empty() && options.fit_joints)
    throw Error("--fit-joints moves the axis around which a joint was baked", "--fit-joints",
                "leave out --fit-joints or --baked, or bake the joint with the fitted rig");
  glide_settings(glide_word(options.glide, options.pose), 1, "--glide " + options.glide);
  if (options.method == kFiniteElements) return;
  std::string given = given_fem_option(*options.fem);
  for (const auto& [is_given, name] :
       {std::pair{!options.solver_mesh.empty(), "--solver-mesh"}, {!options.steps.empty(), "--steps"}})
    if (is_given) given = name;
  if (!given.empty())
    throw Error(given + " needs finite elements", "--method " + options.method, "use --method fem, or leave it out");
}

// Reports the progress of a solve to the user, with an estimate of the remaining time. With --steps, also writes each
// step to a file for another program.
class SolveProgress {
 public:
  SolveProgress(CommandProgress& progress, const Resampling& options, const std::vector<std::string>& bones)
      : progress_(progress),
        name_(options.steps),
        bones_(bones) {}
  // Sets the rig and the target pose of the following steps.
  void aim_at(const Armature& rig, const Pose& pose) {
    rig_ = rig;
    pose_ = pose;
  }
  void begin(const TissueModel& model) const {
    if (!name_.empty()) write_fem_mesh(fem_mesh_of(model), name_);
  }
  void show(const SolveStep& step) {
    if (step.iteration <= 1) watch_ = {};
    leave({step.reached, step.iteration, step.residual, {}, step.V});
    const double left = step.reached > 0 ? watch_.seconds() * (1 / step.reached - 1) : 0;
    progress_.show({step.reached, step.reached * largest_angle_degrees(pose_), step.iteration, step.residual, left});
  }
  // Writes the final step of the solve to the file of --steps.
  void end(const FemShape& shape) const {
    leave({shape.reached, shape.solve.iterations, shape.solve.residual_mm, {}, shape.V});
  }

 private:
  void leave(FemStep step) const {
    if (name_.empty()) return;
    step.motions = bone_motions(bones_, rig_, part_of_pose(pose_, step.reached));
    write_fem_step(step, name_);
  }
  CommandProgress& progress_;
  std::string name_;
  const std::vector<std::string>& bones_;
  Armature rig_;
  Pose pose_;
  Stopwatch watch_;
};

// Adds to the report the pose options and the input files, which only this command knows.
void describe(Report& report, const Resampling& options) {
  auto& settings = report.settings;
  if (!options.field.empty()) settings["field_direction"] = options.field_direction;
  if (!options.pose.body.name.empty())
    settings["pose_name"] = std::string(require_body_pose(options.pose.body.name, "--pose-name").name);
  if (!options.pose.body.joints.empty()) settings["joints"] = options.pose.body.joints;
  if (!options.fem->obstacles.empty()) settings["obstacles"] = options.fem->obstacles;
  if (!options.fem->gravity.empty()) settings["gravity"] = options.fem->gravity;
  if (!options.pose.flex.empty()) settings["flex"] = options.pose.flex;
  if (!options.pose.motion.empty()) settings["frame"] = std::int64_t{options.pose.frame.value_or(0)};
  if (options.pose.up != "y") settings["up"] = options.pose.up;
  for (const std::string& path : options.baked) report.inputs.push_back(describe_input(path));
  for (const std::string& path : {options.body.volume, options.body.rig, options.body.tissues, options.weights,
                                  options.pose.pose, options.pose.motion, options.pose.map})
    if (!path.empty()) report.inputs.push_back(describe_input(path));
}

// Writes the mesh of the whole body in the pose: the tets of the body at rest, with the nodes moved to the pose.
void write_body_mesh(const Resampling& options, const Body& body, const BoundBody& bound, const BakedJoints& baked,
                     BodyInPose& posed, Progress& progress) {
  TissueVoxels tissue = bound.tissue;
  tissue.set_seams(seams_and_joints(body.file.volume, tissue, body.tissues, bound.weights));
  BodyMesh mesh = mesh_of(body.file.volume, tissue, body.tissues, options.mesh, progress);
  PosedMesh moved =
      pose_mesh(mesh, body.file.volume, bound.tissue, body.tissues, bound.weights, posed.rig, posed.pose,
                find_method(options.method)->blend.value_or(Blend::Linear), posed.posed.shape.get(), baked);
  if (moved.inside_out > 0) note(posed.report, {inside_out_warning(moved.inside_out, options.mesh_out)});
  mesh.mesh.V = std::move(moved.V);
  write_mesh(std::move(mesh.mesh), posed.posed.volume, body.tissues, options.mesh.unit, options.mesh_out, progress);
}

void write_outputs(const Resampling& options, const Body& body, Posed& posed, Outputs& outputs) {
  const FieldDirection direction =
      options.field_direction == kToRest ? FieldDirection::ToRest : FieldDirection::ToPosed;
  outputs.write(options.output, [&] { write_volume(posed.volume, options.output, body.tissues, body.file.type); });
  outputs.write(options.field, [&] {
    write_displacement_field(posed.volume.grid, {posed.displacement.data(), posed.displacement.size()}, direction,
                             options.field);
  });
  outputs.write(options.jacobian, [&] { write_scalar_volume(posed.volume.grid, posed.jacobian, options.jacobian); });
  outputs.write(options.overlap, [&] {
    write_volume({posed.volume.grid, std::move(posed.overlap)}, options.overlap, {}, {"NRRD", "uint8", true});
  });
  if (!options.solver_mesh.empty())
    write_mesh(solver_mesh(*posed.shape), posed.volume, body.tissues, options.mesh.unit, options.solver_mesh,
               no_progress());
  if (posed.shape)
    outputs.write(options.fem->pressure,
                  [&] { write_pressure(posed.shape->pressed, posed.shape->objects, options.fem->pressure); });
  if (options.grey.empty()) return;
  const std::string to = grey_paths(options.grey).to;
  outputs.write(to, [&] { write_grey_volume(posed.grey, to); });
}

std::vector<Landmark> posed_landmarks(std::vector<Landmark> landmarks, const Resampling& options, const Body& body,
                                      const BoundBody& bound, const BakedJoints& baked, const BodyInPose& posed) {
  std::vector<glm::dvec3> places;
  for (const Landmark& landmark : landmarks) places.push_back(landmark.position);
  places =
      posed_points(body.file.volume, bound.tissue, body.tissues, bound.weights, posed.rig, posed.pose,
                   find_method(options.method)->blend.value_or(Blend::Linear), posed.posed.shape.get(), places, baked);
  for (size_t i = 0; i < landmarks.size(); ++i) landmarks[i].position = places[i];
  return landmarks;
}

PosingSettings posing_settings(const Resampling& options, const GreyVolume* grey) {
  BakedJoints baked;
  for (const std::string& file : options.baked)
    baked.push_back(std::make_shared<const BakedJoint>(read_baked_joint(file)));
  return {.method = options.method,
          .contact = options.fem->contact,
          .quality = options.fem->quality,
          .mesher = options.fem->mesher,
          .slides = options.fem->slide,
          .estimates_error = options.fem->error_estimate,
          .objects = objects_of(*options.fem),
          .gravity = gravity_of(*options.fem),
          .glide = glide_word(options.glide, options.pose),
          .fit_joints = options.fit_joints,
          .resample = {.nearest = options.nearest,
                       .mass_exact = options.mass_exact,
                       .mass_limit_percent = options.mass_limit,
                       .spacing = options.spacing,
                       .displacement = !options.field.empty(),
                       .tiled_displacement = options.field.empty() && (!options.report.empty() || options.strict),
                       .jacobian = !options.jacobian.empty(),
                       .overlap = !options.overlap.empty(),
                       .grey = grey,
                       .baked = std::move(baked)}};
}

// Writes the outputs and the report of one posed volume. Returns false if a gate failed that --strict requires.
bool finish(const Resampling& options, const Body& body, const BoundBody& bound, const std::vector<Landmark>& landmarks,
            const PosingSettings& settings, BodyInPose& posed, const Stopwatch& total, Progress& progress) {
  const std::shared_ptr<const FemShape> shape = posed.posed.shape;
  Report& report = posed.report;
  if (!options.solver_mesh.empty() && !shape)
    throw Error("the pose bends no tissue, so the solver has no mesh", options.solver_mesh,
                "leave --solver-mesh out, or give a pose");
  if (!options.solver_mesh.empty()) note(report, {share_of_body(shape->model, body.file.volume)});

  Outputs outputs;
  const Stopwatch writing;
  write_outputs(options, body, posed.posed, outputs);
  if (!options.mesh_out.empty()) write_body_mesh(options, body, bound, settings.resample.baked, posed, progress);
  if (!landmarks.empty()) {
    const std::string to = landmark_paths(options.landmarks).to;
    outputs.write(to, [&] {
      write_landmarks(posed_landmarks(landmarks, options, body, bound, settings.resample.baked, posed), to);
    });
  }
  report.seconds.write = writing.seconds();
  if (!options.report.empty() || options.strict) {
    measure_posed_body(body, settings, posed);
    describe(report, options);
    report.seconds.total = total.seconds();
    outputs.write(options.report, [&] { write_report(report, options.report); });
    if (!options.report.empty()) print_table(report);
    tell_failed_gates(failed_gates(report));
  }
  outputs.complete();
  return failed_gates(report).empty();
}

// The requested poses and, for a sequence, the frame number of each pose.
struct RequestedPoses {
  std::vector<Pose> poses;
  std::vector<int> frames;
};
RequestedPoses read_poses(const Resampling& options, const Armature& rig) {
  if (options.frames.empty()) return {{read_pose_options(options.pose, rig)}, {}};
  const std::vector<Pose> all = read_all_poses(options.pose, rig);
  RequestedPoses requested{{}, frames_in(options.frames, int(all.size()), "--frames " + options.frames)};
  for (const int frame : requested.frames) requested.poses.push_back(all[frame]);
  return requested;
}

void run_resample(const Resampling& options) {
  Stopwatch total;
  std::optional<ThreadCount> threads;
  if (options.run.threads > 0) threads.emplace(options.run.threads);
  CommandProgress progress(options.run.progress);
  check_method(options);
  check_sequence(options);
  check_outputs(options.frames.empty() ? options : of_frame(options, 0));
  Report report;
  const Stopwatch reading;
  const Body body = read_body(options.body, progress);
  const auto [poses, frames] = read_poses(options, body.rig);
  std::optional<GreyVolume> grey;
  if (!options.grey.empty()) grey = read_grey_volume(grey_paths(options.grey).from, progress);
  std::vector<Landmark> landmarks;
  if (!options.landmarks.empty()) landmarks = read_landmarks(landmark_paths(options.landmarks).from);
  report.seconds.read = reading.seconds();

  const Stopwatch weighting;
  const SeamChoice seams = read_seam_choice(options.seams, body.file.volume, progress);
  BoundBody bound = options.weights.empty() ? bind_body(body, Binding::Heat, seams, progress)
                                            : read_bound_body(body, options.weights, seams, progress);
  note(report, bound.warnings);
  report.seconds.weights = weighting.seconds();

  const PosingSettings settings = posing_settings(options, grey ? &*grey : nullptr);
  SolveProgress solve(progress, options, bound.weights.bones());
  bool all_reached = true, all_passed = true;
  std::optional<CommandProgress::LeavesAtOnce> nothing_is_being_written(std::in_place);
  const PosingEvents events{.on_warning = [](const std::string& line) { warn(line); },
                            .on_pose =
                                [&](const Armature& rig, const Pose& pose) {
                                  solve.aim_at(rig, pose);
                                  nothing_is_being_written.emplace();
                                },
                            .on_mesh = [&](const TissueModel& model) { solve.begin(model); },
                            .on_step = [&](const SolveStep& step) { solve.show(step); }};
  pose_body(
      body, bound, poses, settings, report, events,
      [&](BodyInPose& posed) {
        nothing_is_being_written.reset();
        if (posed.posed.shape && frames.empty()) solve.end(*posed.posed.shape);
        // Work that was done once for all frames is counted only in the times of the first frame.
        if (posed.index > 0) posed.report.seconds.read = posed.report.seconds.weights = posed.report.seconds.glide = {};
        all_reached &= !posed.posed.report.solve || posed.posed.report.solve->converged;
        all_passed &= finish(frames.empty() ? options : of_frame(options, frames[posed.index]), body, bound, landmarks,
                             settings, posed, total, progress);
        total = {};
      },
      progress);
  if (!all_reached) throw PoseNotReached();
  if (options.strict && !all_passed) throw GateFailed();
}

}  // namespace

void add_resample(CLI::App& app) {
  auto* command = app.add_subcommand("resample", "moves the tissue of a label volume into a pose of its rig");
  auto options = std::make_shared<Resampling>();
  add_body_options(*command, options->body);
  command->add_option("--weights", options->weights, "weights, W.nrrd (default: computed by heat diffusion)");
  add_seam_option(*command, options->seams);
  add_pose_options(*command, options->pose);
  command
      ->add_option(
          "--frames", options->frames,
          "poses several frames of the motion, one after the other: put {frame} into the outputs' names, where each "
          "frame's number replaces it; --method fem makes the mesh once and starts each solve from the frame before")
      ->type_name("FIRST:LAST[:STEP]");
  command->add_option("--method", options->method, method_summaries(Methods::All))
      ->capture_default_str()
      ->check(CLI::IsMember(method_words(Methods::All)));
  add_fem_options(*command, options->fem);
  writes(
      command->add_option("--mesh-out", options->mesh_out,
                          "the whole posed body as tetrahedra, organs and bones included, with the same tets in every "
                          "pose: NAME.node, NAME.ele, NAME.material and colour.dat for particle codes, or NAME.vtu "
                          "or NAME.inp"),
      files_of_mesh(options))
      ->type_name("NAME");
  add_mesh_options(*command, options->mesh, "--mesh-");
  writes(
      command->add_option("--solver-mesh", options->solver_mesh,
                          "with --method fem: the solver's posed mesh, with the main tissue of each tet. It contains "
                          "only the soft tissue that bends; its share of the body is printed"),
      files_of_mesh(options))
      ->type_name("NAME");
  writes(command->add_option("--steps", options->steps,
                             "with --method fem: writes the mesh as NAME.mesh and the newest step of the solve as "
                             "NAME.step, for a program that shows the progress"),
         files_written_to(options, {".mesh", ".step"}))
      ->type_name("NAME");
  add_glide_option(*command, options->glide);
  command
      ->add_option("--baked", options->baked,
                   "joint baked by limber bake-joint: the flesh gets the shape that finite elements computed; for "
                   "--method dqs (repeatable)")
      ->type_name("JOINT.bake");
  command->add_flag(
      "--fit-joints", options->fit_joints,
      "first fits the axis of each bent joint so that its bones do not collide, as 'limber fit-joint' does");
  writes(command->add_option("-o,--output", options->output, "the posed volume"), files_written_to(options))
      ->required();
  writes(command->add_option("--report", options->report, "report of changes: JSON file, and a table on stdout"),
         files_written_to(options));
  command->add_flag(
      "--strict", options->strict,
      "exit with code 5 when a quality gate fails: measures the result as for --report, and still writes all outputs");
  command->add_option("--spacing", options->spacing, "voxel size of the output, mm (default: same as the input)")
      ->check(CLI::Range(1e-9, 1e6));
  command->add_flag("--nearest", options->nearest, "takes the label of the nearest voxel at rest, uninterpolated");
  auto* mass_exact = command->add_flag("--mass-exact", options->mass_exact,
                                       "restores the rest volume of each soft tissue, by changing as few voxels at "
                                       "tissue borders as possible, the least certain first");
  command
      ->add_option("--mass-limit", options->mass_limit,
                   "largest change that --mass-exact may make, percent of a tissue; more is refused (default: 3)")
      ->needs(mass_exact)
      ->check(CLI::Range(0.0, 20.0));
  writes(command->add_option("--with", options->grey, "also poses a grey volume (CT, MR): reads GREY, writes OUT"),
         files_of_pair(options))
      ->type_name("GREY=OUT");
  writes(command->add_option("--landmarks", options->landmarks, "also poses points, CSV files of name,x,y,z (mm, LPS)"),
         files_of_pair(options))
      ->type_name("IN.csv=OUT.csv");
  auto* field = writes(command->add_option("--field", options->field,
                                           "displacement at each posed voxel, mm, world axes (LPS), zero in air: posed "
                                           "minus rest position of the tissue in the voxel"),
                       files_written_to(options));
  command
      ->add_option("--field-direction", options->field_direction,
                   "direction of --field: to-posed (posed minus rest), or to-rest, its negative, with which ITK and "
                   "SimpleITK warp the rest volume into the pose")
      ->capture_default_str()
      ->check(CLI::IsMember({kToPosed, kToRest}))
      ->needs(field);
  writes(command->add_option(
             "--overlap", options->overlap,
             "label volume of overlaps: 1 where two parts of tissue move into one posed voxel, 2 where two bones do"),
         files_written_to(options));
  writes(command->add_option("--jacobian", options->jacobian,
                             "volume ratio at each posed voxel (Jacobian determinant; 1 = unchanged)"),
         files_written_to(options));
  add_run_options(*command, options->run);
  command->callback([options] { run_resample(*options); });
}

}  // namespace limber::cmd
