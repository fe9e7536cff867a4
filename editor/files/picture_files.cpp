// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/files/picture_files.h"

#include <cmath>
#include <cstdio>

#include "core/base/error.h"
#include "core/motion/followed_centre.h"
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/preferences.h"
#include "editor/context/screen.h"
#include "editor/context/views.h"
#include "editor/dialogs/confirm_dialog.h"
#include "editor/dialogs/form_dialog.h"
#include "editor/figure/video.h"
#include "editor/motion/timeline.h"
#include "editor/pose/live_preview.h"
#include "editor/shown/fem_live_view.h"
#include "editor/shown/preview_blend.h"
#include "editor/shown/shown_pose.h"
#include "editor/shown/shown_result.h"
#include "editor/ui/icons.h"
#include "editor/ui/messages.h"
#include "render/image_io.h"

namespace limber::editor {

namespace {

constexpr int kMostPictures = 100'000;  // an export of more pictures is an error

Path numbered(const Path& path, int number) {
  char suffix[16];
  std::snprintf(suffix, sizeof suffix, "-%04d", number);
  return path.parent_path() / (path.stem().string() + suffix + path.extension().string());
}

// Returns the frames of the clip that become pictures: every frame, or for a video as many as its fixed number of
// pictures per second needs. Throws Error if there are too many.
std::vector<int> frames_of_pictures(const Document& document, const Path& path) {
  const auto [low, high] = playing_range(document);
  const double step = is_video(path) ? frame_rate(document) / kPicturesPerSecond : 1;
  const double pictures = std::floor((double(high) - low + 0.5) / step) + 1;
  if (!(pictures <= kMostPictures)) {
    char count[32];
    std::snprintf(count, sizeof count, "%.0f pictures", pictures);
    throw Error("the playing range has too many frames", count, "set a shorter range");
  }
  std::vector<int> frames;
  for (int i = 0; i < static_cast<int>(pictures); ++i)
    frames.push_back(static_cast<int>(std::min<double>(high, low + std::round(i * step))));
  return frames;
}

// Poses the scene for one frame of the clip after another.
class PosedScenes {
 public:
  PosedScenes(Context& context, std::vector<int> frames)
      : clip_(context.document().clips[static_cast<std::size_t>(context.document().clip)], context.document().armature),
        document_(context.document()),
        blend_(preview_blend(context.resampling)),
        frames_(std::move(frames)),
        maker_(context.live->lend()) {
    if (!clip_.problem().empty()) throw Error("the clip cannot be drawn", clip_.clip()->name, clip_.problem());
  }

  // Poses the scene for a picture. Returns false while the frame's preview map is still being computed.
  bool pose(int picture, render::Scene& scene) {
    const int frame = frames_[static_cast<std::size_t>(picture)];
    const PoseWish wish = wish_for_pose(document_, clip_.at(frame), blend_);
    maker_->ask(wish);
    const std::optional<MapMaker::Made> made = maker_->take();
    if (!made || !(made->wish == wish)) return false;
    if (!made->trouble.empty())
      throw Error("the volume cannot follow the pose", "frame " + std::to_string(frame), made->trouble);
    scene.pose = made->map;
    scene.posed_from_rest = made->wish.rig_motions;
    return true;
  }

 private:
  const ClipOnRig clip_;
  const Document document_;
  const Blend blend_;
  const std::vector<int> frames_;
  // Computes preview maps as fine as those that the 3D view shows when the pose does not change.
  const std::shared_ptr<MapMaker> maker_;
};

// Returns the body's centre as the 3D view shows it now. If the shown pose is the clip's pose at the shown frame, this
// is the centre in the clip's motion. Otherwise (frame outside the playing range, or pose changed by hand), it is the
// centre in the shown pose.
glm::dvec3 shown_centre(const Document& document, FollowedCentre& centre) {
  const Clip& clip = *document.shown_clip();
  const bool plays = document.frame >= clip.range_start && document.frame <= clip.range_end;
  const std::shared_ptr<const Pose> of_clip = plays ? pose_at_frame(document) : nullptr;
  const bool is_clip_s = of_clip && (!document.pose || *of_clip == *document.pose);
  return is_clip_s ? centre.at(document.frame) : centre.in_pose(pose_of(document));
}

// Returns the function that gives the camera of each picture. The camera stands still at the 3D view's position, or
// moves with the body and keeps its current position relative to the body.
std::function<render::Camera(int picture)> camera_of_pictures(const Context& context, const std::vector<int>& frames,
                                                              MotionCamera kind) {
  const render::Camera still = context.views->body.camera;
  if (kind == MotionCamera::Still) return [still](int) { return still; };
  const Document& document = context.document();
  const auto centre =
      std::make_shared<FollowedCentre>(document.clips[static_cast<std::size_t>(document.clip)], document.armature);
  return [still, frames, centre, shown = shown_centre(document, *centre)](int picture) {
    render::Camera camera = still;
    camera.centre += centre->at(frames[static_cast<std::size_t>(picture)]) - shown;
    return camera;
  };
}

}  // namespace

glm::ivec2 size_of_view(const Screen& screen, ViewId id) {
  const Rect* place = screen.layout.place_of(id);
  return place ? glm::max(glm::ivec2(place->size()), 16) : glm::ivec2(1280, 720);
}

void agree_on_pictures(Context& context, const Path& path, int pictures, std::function<void(Context&)> begin) {
  check_place(path);
  if (is_video(path)) {
    require_ffmpeg(path);
    return begin(context);
  }
  int there = 0;
  for (int i = 0; i < pictures; ++i) there += std::filesystem::exists(numbered(path, i));
  if (there == 0) return begin(context);
  const std::string first = numbered(path, 0).filename().string(),
                    last = numbered(path, pictures - 1).filename().string();
  ask(context, {.title = "Replace pictures?",
                .lines = {std::to_string(there) + (there == 1 ? " picture" : " pictures") + " of " + first + " to " +
                              last + " already exist.",
                          path.parent_path().string()},
                .icon = icon::kWarning,
                .answers = {{"Cancel", {}}, {"Replace", std::move(begin)}}});
}

void start_picture_files(Context& context, const Path& path, PictureTask task) {
  if (is_video(path)) {
    const auto video = std::make_shared<std::unique_ptr<Video>>();
    task.take = [video, path, size = task.size, scratch = context.preferences->scratch_folder](
                    int i, const render::Image& image, Progress& progress) {
      if (i == 0) *video = std::make_unique<Video>(path, size, scratch, progress);
      (*video)->add(image);
    };
    task.finish = [video, path](Progress&) -> Finish {
      (*video)->finish();
      return
          [path](Context& c) { c.messages->ok("Exported " + path.filename().string(), path.parent_path().string()); };
    };
  } else {
    task.take = [path](int i, const render::Image& image, Progress&) { render::write_png(image, numbered(path, i)); };
    task.finish = [path, pictures = task.pictures](Progress&) -> Finish {
      return [path, pictures](Context& c) {
        c.messages->ok("Exported " + std::to_string(pictures) + (pictures == 1 ? " picture" : " pictures"),
                       path.parent_path().string());
      };
    };
  }
  start_picture_task(context, std::move(task));
}

std::string why_no_motion_pictures(const Context& context) {
  const Document& document = context.document();
  if (!document.volume) return "Open a volume first";
  if (!document.armature) return "Import a rig first";
  if (!shown_clip(context.document())) return "Import a motion first, or insert a key";
  if (!document.weights) return "Compute the weights first";
  if (context.live->is_lent()) return "The pictures of a motion are being drawn";
  if (watched_solve(context)) return "The views show a running solve: switch off \"Watch the solve\" first";
  return shown_result(context) ? "A result is shown: show the volume at rest first" : "";
}

void export_motion_pictures(Context& context, const Path& path, MotionCamera camera) {
  if (const std::string why = why_no_motion_pictures(context); !why.empty())
    throw Error("the motion cannot be shown", path.filename().string(), why);
  const std::vector<int> frames = frames_of_pictures(context.document(), path);
  agree_on_pictures(context, path, static_cast<int>(frames.size()), [path, frames, camera](Context& c) {
    stop_playing(c);
    const auto scenes = std::make_shared<PosedScenes>(c, frames);
    start_picture_files(
        c, path,
        {.label = "Export motion as pictures",
         .scene = c.views->scene,
         .size = size_of_view(c.screen, ViewId::Body),
         .pictures = static_cast<int>(frames.size()),
         .camera = camera_of_pictures(c, frames, camera),
         .prepare = [scenes](int picture, render::Scene& scene) { return scenes->pose(picture, scene); },
         .take = {},
         .finish = {}});
  });
}

void ask_motion_pictures(Context& context, const Path& path) {
  if (const std::string why = why_no_motion_pictures(context); !why.empty())
    throw Error("the motion cannot be shown", path.filename().string(), why);
  const auto outcome = [path](const Context& c, const std::vector<FormField>&) {
    const std::size_t pictures = frames_of_pictures(c.document(), path).size();
    return std::to_string(pictures) + (pictures == 1 ? " picture" : " pictures") + ", drawn in the background.";
  };
  const auto act = [path](Context& c, const std::vector<FormField>& fields) {
    export_motion_pictures(c, path, static_cast<MotionCamera>(fields[0].chosen));
  };
  context.dialogs->open(
      make_form({"Motion as pictures",
                 "Draws the body in each frame of the playing range, with the current camera of the 3D view.",
                 "Export",
                 {choice_of("Camera",
                            "Fixed: the camera does not move. Follow the body: the pelvis, or the root bone, stays at "
                            "the same position in the picture.",
                            {"Fixed", "Follow the body"})},
                 outcome,
                 act}));
}

}  // namespace limber::editor
