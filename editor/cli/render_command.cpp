// SPDX-License-Identifier: AGPL-3.0-or-later
// Defines the command `limber render`, which renders a picture without a window or a display. If it is given a project,
// it uses the project's rig, pose and visibility.
//   limber render VOLUME|PROJECT -o PNG [--size WxH] [--view front|back|left|right|top|bottom] [--turn DEG]
//     [--tilt DEG] [--zoom FACTOR] [--orthographic] [--display solid|xray|tissue] [--shading fine|draft] [--hide L,L]
//     [--opacity L=A] [--clip-box X,Y,Z,X,Y,Z] [--clip-plane X,Y,Z,NX,NY,NZ] [--rig RIG]
//     [--armature octahedron|stick|cylinder|none] [--weights W] [POSE-OPTIONS] [--method lbs|dqs|mix]
//     [--baked JOINT.bake]... [--preview]
//     [--slice axial|coronal|sagittal [--at MM] [--outline]] [--turntable N] [--transparent] [--light] [--grid]
//     [--figure WxH [--dpi N] [--letter A] [--title T] [--paper white|black|transparent] [--no-legend]
//       [--no-scale-bar]]
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/binding/heat_diffusion.h"
#include "core/bones/bone_parts.h"
#include "core/cmd/body_options.h"
#include "core/cmd/command.h"
#include "core/cmd/command_files.h"
#include "core/cmd/pose_options.h"
#include "core/deform/preview_map.h"
#include "core/project/project_io.h"
#include "core/resample/deformation_method.h"
#include "core/resample/resample.h"
#include "core/rig_io/rig_io.h"
#include "core/seams/find_seams.h"
#include "core/skin/weights_io.h"
#include "core/volume_io/grey_image.h"
#include "editor/cli/baked_option.h"
#include "editor/cli/command.h"
#include "editor/cli/figure_options.h"
#include "editor/cli/posed_box.h"
#include "editor/figure/figure_source.h"
#include "editor/figure/video.h"
#include "editor/figure/write_figure.h"
#include "editor/volume/body_seams.h"
#include "render/gl/egl_context.h"
#include "render/image_io.h"
#include "render/scene/tissue_appearance.h"
#include "render/view.h"

namespace limber::editor {

namespace {

using namespace render;

struct Options {
  cmd::BodyOptions body;
  cmd::PoseOptions pose;
  cmd::RunOptions run;
  std::string weights, output, size = "1280x720", slice, armature = "octahedron",
                               method = deformation_methods().front().word;
  StandardView view = StandardView::Front;
  Display display = Display::Solid;
  Light shading = Light::Fine;
  double turn = 0, tilt = 0, zoom = 1;
  std::vector<double> hide, clip_box, clip_plane;
  std::vector<std::string> opacity, baked;
  std::optional<double> at;
  std::optional<int> turntable;
  FigureFlags figure;
  bool orthographic = false, outline = false, transparent = false, light = false, grid = false, preview = false;
};

glm::ivec2 size_of(const std::string& text) {
  int width = 0, height = 0, end = 0;
  if (std::sscanf(text.c_str(), "%dx%d%n", &width, &height, &end) != 2 || end != static_cast<int>(text.size()) ||
      width < 1 || height < 1 || width > 8192 || height > 8192)
    throw Error("this is not a picture size", "--size " + text,
                "write WIDTHxHEIGHT in pixels, each 1 to 8192, as in 1280x720");
  return {width, height};
}

TissueLook& look_at(Visibility& visibility, const TissueTable& tissues, double file_value, const std::string& where) {
  const Tissue* tissue = tissues.find_file_value(file_value);
  if (!tissue) throw Error("no tissue has this label", where, "use labels that `limber info` lists");
  return visibility.looks[tissue->label];
}

// Returns `visibility` after the changes by the options --hide and --opacity.
Visibility visibility_of(const Options& options, const TissueTable& tissues, Visibility visibility) {
  for (const double label : options.hide) {
    char text[32];
    std::snprintf(text, sizeof text, "--hide %.15g", label);
    look_at(visibility, tissues, label, text).visible = false;
  }
  for (const std::string& request : options.opacity) {
    double label = 0, opacity = 0;
    int end = 0;
    if (std::sscanf(request.c_str(), "%lf=%lf%n", &label, &opacity, &end) != 2 ||
        end != static_cast<int>(request.size()) || !(opacity >= 0) || opacity > 1)
      throw Error("this does not have the form LABEL=OPACITY", "--opacity " + request,
                  "write for example 3=0.5; the opacity is 0 to 1");
    look_at(visibility, tissues, label, "--opacity " + request).opacity = static_cast<float>(opacity);
  }
  return visibility;
}

render::Clip clip_of(const Options& options, const Visibility& visibility) {
  const auto point = [](const std::vector<double>& v, size_t first) {
    return glm::dvec3(v[first], v[first + 1], v[first + 2]);
  };
  render::Clip clip;
  if (visibility.clip_box.enabled) clip.box = {visibility.clip_box.low, visibility.clip_box.high};
  if (visibility.clip_plane.enabled) clip.plane = {visibility.clip_plane.point, visibility.clip_plane.normal};
  if (!options.clip_box.empty()) {
    const glm::dvec3 a = point(options.clip_box, 0), b = point(options.clip_box, 3);
    clip.box = {glm::min(a, b), glm::max(a, b)};
  }
  if (!options.clip_plane.empty()) {
    const glm::dvec3 normal = point(options.clip_plane, 3);
    if (!(glm::length(normal) > 0))
      throw Error("a plane needs a direction", "--clip-plane", "give a normal that is not zero");
    clip.plane = {point(options.clip_plane, 0), glm::normalize(normal)};
  }
  return clip;
}

Document read_files(const Options& options, Progress& progress) {
  Document document;
  Body body;
  if (options.body.rig.empty()) {
    if (cmd::wants_pose(options.pose) || !options.weights.empty())
      throw Error("a pose needs a rig", "--rig", "name the file of the rig");
    body.file = read_volume(options.body.volume, progress);
    cmd::warn(body.file.warnings);
    std::optional<TissueTable> user;
    if (!options.body.tissues.empty()) user = read_tissue_table(options.body.tissues);
    body.tissues = merge_tissue_tables(body.file.tissues, user ? &*user : nullptr);
    require_labels(body.file.volume, body.tissues, options.body.volume);
    if (!options.body.bones.empty()) body.tissues = with_bones(std::move(body.tissues), options.body.bones);
  } else {
    body = cmd::read_body(options.body, progress);
    document.armature = std::make_shared<const Armature>(std::move(body.rig));
  }
  document.volume = std::make_shared<const LabelVolume>(std::move(body.file.volume));
  document.tissues = std::make_shared<const TissueTable>(std::move(body.tissues));
  return document;
}

Document read_document(const Options& options, Progress& progress) {
  if (!is_project(options.body.volume)) return read_files(options, progress);
  if (!options.body.rig.empty() || !options.body.tissues.empty() || !options.body.bones.empty() ||
      !options.weights.empty())
    throw Error("a project has its own rig, tissues and weights", options.body.volume,
                "leave out --rig, --tissues, --bones and --weights");
  Project project = read_project(options.body.volume, progress);
  cmd::warn(project.warnings);
  Document& document = project.document;
  if (!document.volume || !document.tissues)
    throw Error("there is nothing to draw: the project has no volume", options.body.volume,
                "import a volume in the editor");
  if (!document.armature && cmd::wants_pose(options.pose))
    throw Error("a pose needs a rig", options.body.volume, "add a rig to the project");
  return std::move(document);
}

std::shared_ptr<const Seams> seams_of(const Document& document, const TissueVoxels& tissue, const BoneParts& parts,
                                      Progress& progress) {
  if (document.seams) return document.seams;
  return std::make_shared<const Seams>(
      find_seams(*document.volume, tissue, *document.tissues, *document.armature, parts, progress));
}

SkinWeights weights_of(const Options& options, const Document& document, Progress& progress) {
  if (document.weights) return *document.weights;
  TissueVoxels tissue(*document.volume);
  if (options.weights.empty()) {
    const BoneParts parts = split_bones(*document.volume, tissue, *document.tissues, *document.armature, progress,
                                        usable_bone_map(seam_source(document)));
    tissue.set_seams(seams_of(document, tissue, parts, progress));
    return diffuse_heat(*document.volume, tissue, *document.tissues, *document.armature, parts, {}, progress);
  }
  WeightsFile file = read_weights(options.weights, *document.volume, tissue, *document.armature);
  cmd::warn(file.warnings);
  return std::move(file.weights);
}

// The scene to render, with the posed volume and rig.
struct PosedScene {
  Scene scene;
  std::optional<std::array<glm::dvec3, 2>> tissue;  // bounding box of the posed tissue, voxels of the scene's volume
};
PosedScene posed_scene(const Options& options, const Document& document, Progress& progress) {
  PosedScene result{{.volume = document.volume, .armature = document.armature}, {}};
  Scene& scene = result.scene;
  check_baked_files(options.baked, options.method);
  if (!document.armature) return result;
  Pose pose = document.pose ? *document.pose : rest_pose(*document.armature);
  if (cmd::wants_pose(options.pose)) pose = cmd::read_pose_options(options.pose, *document.armature);
  if (pose == rest_pose(*document.armature)) return result;
  const SkinWeights weights = weights_of(options, document, progress);
  const Blend blend = *find_blend(options.method);
  const TissueVoxels tissue(*document.volume);
  scene.posed_from_rest = posed_from_rest(*document.armature, pose);
  const BakedJoints baked = baked_joints_for(options.baked, options.method, document, tissue, weights);
  // The argument "off" says that the bones in this picture only rotate about their joints, without the small shifts
  // that keep bones from overlapping.
  cmd::warn(doubts_of_baked(report_of_baked(baked, *document.armature, pose), "off"));
  if (options.preview) {
    LivePreview preview(document.volume, *document.tissues, tissue, weights, preview_step(tissue));
    scene.pose = preview.update(scene.posed_from_rest, blend, {}, joints_in_pose(baked, *document.armature, pose));
    result.tissue =
        box_of_posed(document.volume->grid, document.volume->grid, tissue, weights, scene.posed_from_rest, blend);
    return result;
  }
  const BoneParts parts = split_bones(*document.volume, tissue, *document.tissues, *document.armature, progress,
                                      usable_bone_map(seam_source(document)));
  Posed posed = resample(*document.volume, *document.tissues, *document.armature, weights, pose, blend,
                         {.seams = seams_of(document, tissue, parts, progress), .baked = baked}, progress);
  scene.volume = std::make_shared<const LabelVolume>(std::move(posed.volume));
  result.tissue =
      box_of_posed(document.volume->grid, scene.volume->grid, tissue, weights, scene.posed_from_rest, blend);
  return result;
}

// Returns the box that the picture must show, in the world, mm: the bounding box of the tissue, intersected with the
// clip box.
std::array<glm::dvec3, 2> box_of_tissue(const PosedScene& posed, const render::Clip& clip) {
  const LabelVolume& volume = *posed.scene.volume;
  glm::dvec3 from, to;
  if (posed.tissue) {
    from = (*posed.tissue)[0], to = (*posed.tissue)[1];
  } else {
    glm::ivec3 low = volume.grid.size, high(-1);
    size_t i = 0;
    for (int z = 0; z < volume.grid.size.z; ++z)
      for (int y = 0; y < volume.grid.size.y; ++y)
        for (int x = 0; x < volume.grid.size.x; ++x, ++i)
          if (volume.voxels[i] != 0)
            low = glm::min(low, glm::ivec3(x, y, z)), high = glm::max(high, glm::ivec3(x, y, z));
    if (high.x < 0) low = glm::ivec3(0), high = volume.grid.size - 1;
    from = glm::dvec3(low) - 0.5;
    to = glm::dvec3(high) + 0.5;
  }
  if (clip.box) {
    from = glm::max(from, (*clip.box)[0]);
    to = glm::max(glm::min(to, (*clip.box)[1]), from);
  }
  const AffineTransform to_world = world_from_voxel(volume.grid);
  glm::dvec3 world_low(1e300), world_high(-1e300);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p =
        to_world * glm::dvec3(corner & 1 ? to.x : from.x, corner & 2 ? to.y : from.y, corner & 4 ? to.z : from.z);
    world_low = glm::min(world_low, p);
    world_high = glm::max(world_high, p);
  }
  return {world_low, world_high};
}

Camera turned(const Camera& camera, double turn_degrees, double tilt_degrees) {
  Camera result = camera;
  const double radians = std::numbers::pi / 180;
  const glm::dvec3 right = camera.world_from_view * glm::dvec3(1, 0, 0);
  result.world_from_view = glm::normalize(glm::angleAxis(turn_degrees * radians, glm::dvec3(0, 0, 1)) *
                                          glm::angleAxis(-tilt_degrees * radians, right) * camera.world_from_view);
  return result;
}

Image picture_3d(Renderer& renderer, const Scene& scene, const Camera& camera, const glm::ivec2& size) {
  View3D view(renderer);
  for (double now = 0; now == 0 || !view.complete(); now += 1) view.draw(scene, camera, size, now);
  return view.read();
}

// Returns a function that takes a picture's size in pixels and returns the camera that shows the whole slice in it.
SliceCameraAt slice_camera_of(const PosedScene& posed, const Options& options) {
  static const std::map<std::string, SliceAxis> axes = {
      {"axial", SliceAxis::Axial}, {"coronal", SliceAxis::Coronal}, {"sagittal", SliceAxis::Sagittal}};
  const auto [low, high] = box_of_tissue(posed, {});
  SliceCamera camera{.axis = axes.at(options.slice), .centre = (low + high) / 2.0};
  const SliceFrame frame = frame_of(camera.axis);
  if (options.at) camera.centre += frame.normal * (*options.at - glm::dot(camera.centre, frame.normal));
  const double width = std::abs(glm::dot(high - low, frame.right)), height = std::abs(glm::dot(high - low, frame.down));
  return [camera, width, height, zoom = options.zoom](const glm::ivec2& size) {
    SliceCamera fitted = camera;
    fitted.millimetres_per_pixel = 1.06 * std::max({width / size.x, height / size.y, 1e-6}) / zoom;
    return fitted;
  };
}

SliceDisplay slice_display(const Options& options) {
  return options.outline ? SliceDisplay::Outline : SliceDisplay::Labels;
}

Image picture_slice(Renderer& renderer, const Scene& scene, const Options& options, const SliceCamera& camera,
                    const glm::ivec2& size) {
  SliceView view(renderer);
  view.draw(scene, camera, slice_display(options), size);
  return view.read();
}

// Returns a function that takes a picture's size in pixels and returns the camera that shows the whole body in it.
CameraAt camera_of(const PosedScene& posed, const Options& options) {
  Camera camera;
  if (options.orthographic) camera.projection = Projection::Orthographic;
  camera = turned(looking_from(options.view, camera), options.turn, options.tilt);
  const auto [low, high] = box_of_tissue(posed, posed.scene.clip);
  return [camera, low = low, high = high, zoom = options.zoom](const glm::ivec2& size) {
    return zoomed(framing(camera, low, high, double(size.x) / size.y), 1 / zoom);
  };
}

void draw_figure(Renderer& renderer, const PosedScene& posed, const Options& options, const FigureOptions& wanted,
                 const std::shared_ptr<const TissueTable>& tissues) {
  const Lettering lettering;
  Scene scene = figure_scene(posed.scene);
  if (options.slice.empty()) {
    const CameraAt camera = camera_of(posed, options);
    const FigureLayout layout = figure_layout(wanted, body_source(renderer, scene, camera, tissues), lettering);
    const glm::ivec2& size = layout.picture_pixels;
    scene.line_scale = figure_line_scale(layout);
    return write_figure(layout, picture_3d(renderer, scene, camera(size), size), lettering, options.output);
  }
  const SliceCameraAt camera = slice_camera_of(posed, options);
  const FigureLayout layout =
      figure_layout(wanted, slice_source(scene, camera, slice_display(options), tissues), lettering);
  const glm::ivec2& size = layout.picture_pixels;
  scene.line_scale = figure_line_scale(layout);
  write_figure(layout, picture_slice(renderer, scene, options, camera(size), size), lettering, options.output);
}

// Returns the path of a numbered picture: NAME-0000.png in the same folder as NAME.png.
std::string numbered(const std::string& path, int number) {
  const std::filesystem::path whole(path);
  char suffix[16];
  std::snprintf(suffix, sizeof suffix, "-%04d", number);
  return (whole.parent_path() / (whole.stem().string() + suffix + whole.extension().string())).string();
}

cmd::OptionFiles files_of_pictures(const Options& options, const std::string& name) {
  cmd::OptionFiles files;
  if (!options.turntable || is_video(name)) {
    files.written.emplace_back(name);
    return files;
  }
  for (int i = 0; i < *options.turntable; ++i) files.written.emplace_back(numbered(name, i));
  return files;
}

// Draws one picture, or a turntable of pictures, and writes them as PNG files or as a video.
void draw_pictures(Renderer& renderer, const PosedScene& posed, const Options& options, const glm::ivec2& size,
                   Progress& progress) {
  const Camera camera = camera_of(posed, options)(size);
  const int pictures = options.turntable.value_or(1);
  std::optional<Video> video;
  if (is_video(options.output)) video.emplace(options.output, size, "", progress);
  for (int i = 0; i < pictures; ++i) {
    progress.update("pictures", double(i) / pictures);
    const Image image = picture_3d(renderer, posed.scene, turned(camera, 360.0 * i / pictures, 0), size);
    if (video) video->add(image);
    else write_png(image, options.turntable ? numbered(options.output, i) : options.output);
  }
  if (video) video->finish();
}

// Throws Error if the output cannot be written or the options exclude each other, before a long computation begins.
void check_output(const Options& options, bool figure) {
  const Path output = options.output;
  check_place(options.turntable && !is_video(output) ? Path(numbered(options.output, 0)) : output);
  if (figure) return check_figure_path(output);
  if (!is_video(output)) return;
  if (!options.turntable || !options.slice.empty())
    throw Error("a video needs a turntable", options.output, "add --turntable N, without --slice");
  if (options.transparent)
    throw Error("a video cannot have a transparent background", options.output,
                "leave out --transparent, or use a name that ends in .png for numbered pictures");
  require_ffmpeg(output);
}

void run(const Options& options) {
  const glm::ivec2 size = size_of(options.size);
  std::optional<ThreadCount> threads;
  if (options.run.threads > 0) threads.emplace(options.run.threads);
  cmd::CommandProgress progress(options.run.progress);
  const std::optional<FigureOptions> figure = figure_of(options.figure);
  check_output(options, figure.has_value());

  const Document document = read_document(options, progress);
  const Visibility visibility =
      visibility_of(options, *document.tissues, document.visibility ? *document.visibility : Visibility{});
  PosedScene posed = posed_scene(options, document, progress);
  Scene& scene = posed.scene;
  scene.looks = std::make_shared<const LabelLooks>(looks_of(*document.tissues, visibility));
  scene.display = options.display;
  scene.clip = clip_of(options, visibility);
  scene.bone_shape = options.armature == "none"       ? BoneShape::None
                     : options.armature == "stick"    ? BoneShape::Stick
                     : options.armature == "cylinder" ? BoneShape::Cylinder
                                                      : BoneShape::Octahedron;
  scene.bones_in_front = options.display == Display::XRay;
  scene.grid = options.grid;
  scene.dark_background = !options.light;
  scene.transparent_background = options.transparent;

  const HeadlessContext context;
  Renderer renderer;
  renderer.light_at_rest(options.shading);
  if (figure) draw_figure(renderer, posed, options, *figure, document.tissues);
  else if (!options.slice.empty())
    write_png(picture_slice(renderer, scene, options, slice_camera_of(posed, options)(size), size), options.output);
  else draw_pictures(renderer, posed, options, size, progress);
  if (!renderer.note().empty()) cmd::warn(renderer.note());
}

}  // namespace

void add_render(CLI::App& app) {
  auto* command = app.add_subcommand("render", "draws a picture of a volume or a project; needs no display");
  auto options = std::make_shared<Options>();
  command->add_option("VOLUME", options->body.volume, "label volume or project")->required();
  cmd::writes(command->add_option("-o,--output", options->output, "picture to write (.png), or a video or figure"),
              [options](const std::string& name) { return files_of_pictures(*options, name); })
      ->required();
  command->add_option("--tissues", options->body.tissues, "tissue table (JSON, .ctbl, ITK-SNAP)");
  command->add_option("--bones", options->body.bones, "labels that are bone, as numbers in the volume file")
      ->delimiter(',')
      ->type_name("L,L");
  command->add_option("--size", options->size, "size of the picture, pixels")->type_name("WxH")->capture_default_str();
  command->add_option("--view", options->view, "side of the body from which the camera looks (default: front)")
      ->transform(CLI::CheckedTransformer(std::map<std::string, StandardView>{{"front", StandardView::Front},
                                                                              {"back", StandardView::Back},
                                                                              {"left", StandardView::Left},
                                                                              {"right", StandardView::Right},
                                                                              {"top", StandardView::Top},
                                                                              {"bottom", StandardView::Bottom}}));
  command->add_option("--turn", options->turn, "turns the view about the vertical axis, degrees (default: 0)");
  command->add_option("--tilt", options->tilt, "tilts the view to look down, degrees (default: 0)");
  command->add_option("--zoom", options->zoom, "zoom factor; 2 is twice as large (default: 1)")
      ->check(CLI::Range(0.01, 100.0));
  command->add_flag("--orthographic", options->orthographic, "parallel projection, without perspective");
  command
      ->add_option("--display", options->display,
                   "how tissue is shown: solid (default), xray (soft tissue transparent) or tissue (by opacities)")
      ->transform(CLI::CheckedTransformer(std::map<std::string, Display>{
          {"solid", Display::Solid}, {"xray", Display::XRay}, {"tissue", Display::Tissue}}));
  command
      ->add_option(
          "--shading", options->shading,
          "fine (default): soft shadows and ambient occlusion by rays, as in the editor when nothing moves; about a "
          "second longer per picture without a graphics card. draft: simple light, as in a moving view")
      ->transform(
          CLI::CheckedTransformer(std::map<std::string, Light>{{"fine", Light::Fine}, {"draft", Light::Draft}}));
  command->add_option("--hide", options->hide, "labels to hide, as numbers in the volume file")
      ->delimiter(',')
      ->type_name("L,L");
  command->add_option("--opacity", options->opacity, "opacity of a label in the tissue display, 0 to 1")
      ->type_name("L=A");
  command->add_option("--clip-box", options->clip_box, "hides everything outside a box, given by two corners in voxels")
      ->delimiter(',')
      ->expected(6)
      ->type_name("X,Y,Z,X,Y,Z");
  command
      ->add_option("--clip-plane", options->clip_plane,
                   "hides one side of a plane, given by a point in mm and a normal that points to the hidden side")
      ->delimiter(',')
      ->expected(6)
      ->type_name("X,Y,Z,NX,NY,NZ");
  command->add_option("--rig", options->body.rig, "rig to draw and to pose with");
  command->add_option("--armature", options->armature, "how bones are drawn (default: octahedron)")
      ->check(CLI::IsMember({"octahedron", "stick", "cylinder", "none"}));
  command->add_option("--weights", options->weights,
                      "weights for the pose, W.nrrd (default: computed by heat diffusion)");
  cmd::add_pose_options(*command, options->pose);
  command->add_option("--method", options->method, "how the pose moves tissue: " + method_summaries(Methods::Blends))
      ->check(CLI::IsMember(method_words(Methods::Blends)))
      ->capture_default_str();
  command->add_option("--baked", options->baked, "joint baked by limber bake-joint, for --method dqs (repeatable)")
      ->type_name("JOINT.bake");
  command->add_flag("--preview", options->preview, "draws the editor's coarse preview of the pose, which is fast");
  command->add_option("--slice", options->slice, "draws a slice instead of a 3D picture")
      ->check(CLI::IsMember({"axial", "coronal", "sagittal"}));
  command->add_option("--at", options->at, "position of the slice on its axis, mm (default: the middle)");
  command->add_flag("--outline", options->outline, "draws only the borders of tissues in the slice");
  command
      ->add_option("--turntable", options->turntable,
                   "turntable: draws N pictures while the camera goes once around: NAME-0000.png and so on, or a video "
                   "(-o NAME.mp4 or .webm; needs ffmpeg)")
      ->check(CLI::Range(1, 9999));
  command->add_flag("--transparent", options->transparent, "makes the background transparent");
  command->add_flag("--light", options->light, "uses the light theme's background (default: the dark theme's)");
  command->add_flag("--grid", options->grid, "draws the ground grid");
  add_figure_options(*command, options->figure);
  for (const char* other : {"--size", "--turntable", "--transparent", "--light", "--grid"})
    command->get_option("--figure")->excludes(command->get_option(other));
  cmd::add_run_options(*command, options->run);
  command->callback([options] { run(*options); });
}

}  // namespace limber::editor
