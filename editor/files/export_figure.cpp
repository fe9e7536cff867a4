// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/files/export_figure.h"

#include <algorithm>

#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/open_project.h"
#include "editor/context/screen.h"
#include "editor/context/views.h"
#include "editor/dialogs/form_dialog.h"
#include "editor/figure/figure_source.h"
#include "editor/figure/write_figure.h"
#include "editor/file_browser/file_browser.h"
#include "editor/files/picture_task.h"
#include "editor/ui/messages.h"

namespace limber::editor {

namespace {

using Paper = FigureOptions::Paper;

// Time limit of one step of uploading the slice's data, s. Steps are repeated until the slice is complete.
constexpr double kUploadTime = 1;

bool shows_slice(const Context& context) {
  return context.views->active != ViewId::Body && context.screen->layout.place_of(context.views->active);
}

glm::dvec2 size_of_active(const Context& context) {
  const Rect* place = context.screen->layout.place_of(context.views->active);
  return place ? glm::dvec2(place->size()) : glm::dvec2(16, 9);
}

// Returns the view's camera for a picture of another aspect ratio. If the picture is narrower than the view, the
// camera is moved back, so that the picture shows the same part of the body.
CameraAt camera_for(const Context& context) {
  const glm::dvec2 view = size_of_active(context);
  return [camera = context.views->body.camera, view](const glm::ivec2& size) {
    return zoomed(camera, std::max(1.0, view.x / view.y * size.y / size.x));
  };
}
SliceCameraAt slice_camera_for(Context& context) {
  const glm::dvec2 view = size_of_active(context);
  return [camera = slice_of(*context.views, context.views->active).camera, view](const glm::ivec2& size) {
    render::SliceCamera fitted = camera;
    fitted.millimetres_per_pixel *= std::max(view.x / size.x, view.y / size.y);
    return fitted;
  };
}

FigureOptions options_of(const std::vector<FormField>& fields) {
  FigureOptions options;
  options.size = {fields[0].value, fields[1].value};
  options.dots_per_inch = fields[2].value;
  options.letter = fields[3].text;
  options.title = fields[4].text;
  options.paper = static_cast<Paper>(fields[5].chosen);
  options.legend = fields[6].chosen == 0;
  options.scale_bar = fields[7].chosen == 0;
  return options;
}

// Returns the scene with the line width that the figure's size and resolution require, independent of the editor's own
// scale.
render::Scene for_page(render::Scene scene, const FigureLayout& layout) {
  scene.line_scale = figure_line_scale(layout);
  return scene;
}

void finish_export(Messages& messages, const Path& path) {
  messages.ok("Exported " + path.filename().string(), path.parent_path().string());
}

}  // namespace

void ask_for_figure(Dialogs& dialogs, const std::shared_ptr<FigureOptions>& last) {
  const auto outcome = [](const Context& c, const std::vector<FormField>& fields) {
    const glm::ivec2 pixels = figure_pixels(options_of(fields));
    const bool perspective =
        !shows_slice(c) && c.views->body.camera.projection == render::Projection::Perspective && fields[7].chosen == 0;
    return std::to_string(pixels.x) + " x " + std::to_string(pixels.y) + " pixels." +
           (perspective ? " The scale bar is exact at the depth of the view's centre. In parallel projection it is "
                          "exact everywhere."
                        : "");
  };
  const auto act = [last](Context& c, const std::vector<FormField>& fields) {
    const FigureOptions options = *last = options_of(fields);
    browse(c,
           {.purpose = "picture",
            .title = "Export figure",
            .action = "Export",
            .kind = FileRequest::Kind::Save,
            .filters = {{"PNG pictures", {".png"}}, {"TIFF pictures", {".tif", ".tiff"}}, {"SVG drawings", {".svg"}}},
            .name = (c.project->name.empty() ? "Untitled" : Path(c.project->name).stem().string()) + "-figure.png",
            .folder = c.project->path.parent_path(),
            .chosen = [options](Context& c, const Path& path) { export_figure(c, options, path); }});
  };
  dialogs.open(make_form(
      {"Export figure",
       "Exports the active view for a publication, with a scale bar and a legend of its tissues.",
       "Export...",
       {number_of("Width", "Width of the printed figure.", last->size.x, kSmallestFigure, kLargestFigure, "%.1f", "mm"),
        number_of("Height", "Height of the printed figure.", last->size.y, kSmallestFigure, kLargestFigure, "%.1f",
                  "mm"),
        number_of("Resolution", "Pixels per inch of the printed figure. Journals ask for 300 to 600.",
                  last->dots_per_inch, kLowestResolution, kHighestResolution, "%.0f", "dpi"),
        text_of("Letter", "Letter in the figure's corner, such as \"a\". May be empty.", last->letter),
        text_of("Title", "Title above the picture. May be empty.", last->title),
        choice_of("Background", "Colour of the figure's background.", {"White", "Black", "None"},
                  static_cast<int>(last->paper)),
        choice_of("Legend", "Names and colours of the tissues that the picture shows.", {"Show", "Leave out"},
                  last->legend ? 0 : 1),
        choice_of("Scale bar", "Scale bar that shows a round length, such as 50 mm.", {"Show", "Leave out"},
                  last->scale_bar ? 0 : 1)},
       outcome,
       act,
       {}}));
}

void export_figure(Context& context, const FigureOptions& options, const Path& path) {
  check_place(path);
  check_figure_path(path);
  Views& views = *context.views;
  const auto lettering = std::make_shared<const Lettering>();
  render::Scene scene = figure_scene(drawn_scene(views));
  const auto& tissues = context.document().tissues;
  const std::string label = "Export " + path.filename().string();
  const auto done = [path](Progress&) -> Finish { return [path](Context& c) { finish_export(c.messages, path); }; };
  if (!shows_slice(context)) {
    const CameraAt camera = camera_for(context);
    const FigureLayout layout = figure_layout(options, body_source(views.renderer, scene, camera, tissues), *lettering);
    return start_picture_task(
        context, {.label = label,
                  .scene = for_page(std::move(scene), layout),
                  .size = layout.picture_pixels,
                  .camera = [at = camera(layout.picture_pixels)](int) { return at; },
                  .take = [layout, lettering, path](int, const render::Image& image,
                                                    Progress&) { write_figure(layout, image, *lettering, path); },
                  .finish = done});
  }
  const SliceCameraAt camera = slice_camera_for(context);
  const FigureLayout layout =
      figure_layout(options, slice_source(scene, camera, views.slice_display, tissues), *lettering);
  scene = for_page(std::move(scene), layout);
  render::SliceView view(views.renderer);
  do {
    views.renderer.begin_frame(kUploadTime);
    view.draw(scene, camera(layout.picture_pixels), views.slice_display, layout.picture_pixels);
  } while (!view.complete());
  start_task(context, label, [layout, lettering, path, done, image = view.read()](Progress& progress) -> Finish {
    write_figure(layout, image, *lettering, path);
    return done(progress);
  });
}

}  // namespace limber::editor
