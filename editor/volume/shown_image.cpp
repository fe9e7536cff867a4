// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/volume/shown_image.h"

#include <array>
#include <cmath>
#include <cstdio>

#include "core/base/error.h"
#include "core/tissue/tissue_table.h"
#include "editor/context/arriving_body.h"
#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"

namespace limber::editor {

namespace {

constexpr std::array kCtWindows = {
    ImageWindow{"image.window_soft", "Soft tissue", 40, 400}, ImageWindow{"image.window_bone", "Bone", 480, 2500},
    ImageWindow{"image.window_lung", "Lung", -600, 1500}, ImageWindow{"image.window_brain", "Brain", 40, 80}};

Box box_of_grid(const Grid& grid) {
  Document document;
  document.volume = std::make_shared<const LabelVolume>(LabelVolume{grid, {}});
  return world_box(document);
}

// Returns the size of the gap between two boxes, mm; 0 if they touch or overlap.
double gap_between(const Box& a, const Box& b) {
  return glm::length(glm::max(glm::max(a.low - b.high, b.low - a.high), glm::dvec3(0)));
}

void require_same_place(const Document& document, const GreyLevels& image, const Path& path) {
  if (!document.volume) return;
  const double gap = gap_between(world_box(document), box_of_grid(image.grid));
  if (gap <= 0) return;
  char text[120];
  std::snprintf(text, sizeof text, "this image lies %.0f mm away from the open body", gap);
  throw Error(text, path.string(), "open the image of this body, or start a new project for this image");
}

}  // namespace

std::span<const ImageWindow> ct_windows() { return kCtWindows; }

bool looks_like_ct(const GreyLevels& image) { return image.least < -700 && image.least > -5000 && image.most() > 150; }

std::shared_ptr<const GreyLevels> levels_of(const GreyVolume& image) {
  return std::make_shared<const GreyLevels>(grey_levels(image.grid, image.voxels));
}

render::ShownGrey usually_shown(std::shared_ptr<const GreyLevels> image) {
  render::ShownGrey shown;
  if (!looks_like_ct(*image)) {
    const auto [level, width] = usual_window(*image);
    shown.level = level;
    shown.width = width;
    shown.rendering = render::GreyRendering::Window;
  }
  shown.image = std::move(image);
  return shown;
}

void show_image(Context& context, const render::ShownGrey& shown, const Path& path) {
  require_same_place(context.document(), *shown.image, path);
  context.views->image = shown;
  context.views->image_path = path;
  context.ui->touch();
}

Document document_for_image(const GreyLevels& image) {
  LabelVolume air;
  air.grid = image.grid;
  air.voxels.resize(static_cast<std::size_t>(image.grid.voxel_count()));
  Document document;
  document.volume = std::make_shared<const LabelVolume>(std::move(air));
  document.tissues = std::make_shared<const TissueTable>();
  document.volume_type = std::make_shared<const FileType>(FileType{"NRRD", "uint8", true});
  return document;
}

void close_image(Context& context) {
  context.views->image.reset();
  context.views->image_path.clear();
  context.ui->touch();
}

void reopen_image(Context& context, const Path& path, const std::optional<render::ShownGrey>& saved) {
  context.views->image_path =
      path;  // set already now, so that a project saved before the image is read names the image
  start_task(
      context, "Open image " + path.filename().string(),
      [path, saved, body = context.document(), make_ready = body_maker(*context.views)](Progress& progress) -> Finish {
        const auto image = levels_of(read_grey_volume(path, progress));
        render::ShownGrey shown = saved ? *saved : usually_shown(image);
        shown.image = image;
        make_ready(body, progress, shown);
        return [shown, path](Context& c) {
          if (c.views->image || c.views->image_path != path) return;  // another image or project was opened meanwhile
          show_image(c, shown, path);
        };
      },
      [path](Context& c, const std::string& error) {
        c.messages->warn("The image of this project is not shown: " + path.filename().string(), error);
      });
}

void keep_posed_image(Views& views, PosedImage image) {
  std::erase_if(views.posed_images, [](const PosedImage& kept) { return kept.result.expired(); });
  views.posed_images.push_back(std::move(image));
}

const PosedImage* posed_image_of(const Views& views, const std::shared_ptr<const LabelVolume>& result) {
  for (const PosedImage& image : views.posed_images)
    if (image.result.lock() == result) return &image;
  return nullptr;
}

std::optional<double> image_value_at(const GreyLevels& image, const glm::dvec3& world) {
  const glm::ivec3 voxel(glm::floor(voxel_from_world(image.grid) * world + 0.5));
  if (!image.grid.contains(voxel)) return std::nullopt;
  return image.value_at(voxel);
}

std::optional<double> image_value_at_pointer(const Views& views) {
  const Hover& hover = views.hover;
  const render::Scene& scene = views.scene;
  if (!scene.grey || !hover.view || !(hover.inside || (*hover.view != ViewId::Body && !scene.pose)))
    return std::nullopt;
  const bool at_rest = hover.inside && scene.pose;
  return image_value_at(*scene.grey->image,
                        at_rest ? world_from_voxel(scene.volume->grid) * glm::dvec3(hover.voxel) : hover.point);
}

std::string text_of_image_value(const Views& views, double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4g%s", value, looks_like_ct(*views.image->image) ? " HU" : "");
  return text;
}

}  // namespace limber::editor
