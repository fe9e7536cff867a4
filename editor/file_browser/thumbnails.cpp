// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/file_browser/thumbnails.h"

#include <algorithm>
#include <utility>

#include "core/base/error.h"
#include "core/project/project_io.h"
#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/context/recent_files.h"
#include "editor/context/screen.h"
#include "editor/context/start_screen_state.h"
#include "editor/context/user_folders.h"
#include "editor/context/views.h"
#include "editor/ui/texture_cache.h"
#include "editor/ui/ui.h"
#include "render/image_io.h"

namespace limber::editor {

namespace fs = std::filesystem;

namespace {

render::Scene thumbnail_scene(Context& context) {
  update_scene(*context.views, context.document(), context.selection, true);
  render::Scene scene = context.views->scene;
  scene.grid = false;
  scene.outlined.reset();
  scene.dark_background = true;
  return scene;
}

}  // namespace

std::string thumbnail_png(Context& context) {
  Views& views = *context.views;
  if (!context.document().volume) return "";
  const render::Scene scene = thumbnail_scene(context);
  render::View3D picture(views.renderer);
  // Advances the time given to the renderer by a second per call. The renderer refines the picture of a view that has
  // not changed for a while; so it draws full detail without a real wait.
  for (double now = 0; now == 0 || !picture.complete(); now += 1)
    picture.draw(scene, views.body.camera, kThumbnailSize, now, 1);
  return render::png_of(picture.read());
}

Path cached_thumbnail(const Path& cache, const Path& path) {
  std::error_code error;
  const auto changed = fs::last_write_time(path, error).time_since_epoch().count();
  const std::string key = path.string() + " " + std::to_string(error ? 0 : changed);
  return cache / "thumbnails" / (sha256_of_bytes(key.data(), key.size()).substr(0, 24) + ".png");
}

void keep_thumbnail(Context& context, const Path& path) {
  if (context.folders->cache.empty() || !context.document().volume) return;
  const auto picture = std::make_shared<render::View3D>(context.views->renderer);
  const Path file = cached_thumbnail(context.folders->cache, path);
  render::Scene scene = thumbnail_scene(context);
  // Removes these parts of the scene, because they may still belong to the body that was shown before.
  scene.pose.reset();
  scene.posed_from_rest.clear();
  scene.weights.reset();
  scene.mesh.reset();
  scene.grey.reset();
  // Draws a part of the picture in each frame, after the views have finished their own pictures of this body.
  context.background->each_frame.push_back(
      [picture, file, time = 0.0, is_shown = false, scene, camera = context.views->body.camera](Context& c) mutable {
        c.ui->touch();
        if (!std::exchange(is_shown, true)) return true;
        if (c.screen->layout.place_of(ViewId::Body) && !c.views->body.picture->complete()) return true;
        try {
          picture->draw(scene, camera, kThumbnailSize, time += 1, 1);
        } catch (const Error&) {
          return false;
        }
        if (!picture->complete()) return true;
        start_task(c, "", [file, image = picture->read()](Progress&) -> Finish {
          try {
            fs::create_directories(file.parent_path());
            write_file_atomically(file, render::png_of(image));
          } catch (const Error&) {
          } catch (const fs::filesystem_error&) {
          }
          return {};
        });
        return false;
      });
}

void look_at_recents(Context& context) {
  start_task(context, "",
             [recents = context.recent_files->recents, cache = context.folders->cache](Progress&) -> Finish {
               auto facts = std::make_shared<std::map<Path, RecentFacts>>();
               for (std::size_t i = 0; i < std::min<std::size_t>(recents.size(), 8); ++i) {
                 const Path& path = recents[i].path;
                 RecentFacts& one = (*facts)[path];
                 std::error_code error;
                 one.missing = !fs::exists(path, error);
                 if (one.missing) continue;
                 try {
                   const std::string packed = path.extension() == ".limber" ? read_thumbnail(path) : "";
                   if (!packed.empty())
                     one.picture = std::make_shared<render::Image>(render::parse_png(packed, path.string()));
                   else if (!cache.empty())
                     one.picture = std::make_shared<render::Image>(render::read_png(cached_thumbnail(cache, path)));
                 } catch (const Error&) {  // ignored: the file is then listed without a picture
                 }
               }
               return [facts](Context& c) {
                 for (const auto& [path, one] : *facts) c.pictures->forget("recent " + path.string());
                 c.start_screen->facts = std::move(*facts);
               };
             });
}

}  // namespace limber::editor
