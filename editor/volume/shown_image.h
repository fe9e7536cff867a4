// SPDX-License-Identifier: AGPL-3.0-or-later
// The grey image (CT, MR) that the views show with the labels (Views::image): opening and closing it, and the windows
// of grey values in which it is shown. The image is not part of the document: the project stores only the path of the
// image's file, and reads the file again when the project is opened.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "core/volume/grey_levels.h"
#include "core/volume_io/volume_io.h"
#include "editor/context/views.h"

namespace limber::editor {

struct Context;

// A window of grey values, as radiologists use for CT, in Hounsfield units.
struct ImageWindow {
  const char *id, *name;
  double level, width;
};
std::span<const ImageWindow> ct_windows();

// Returns true if the values look like Hounsfield units: air at about -1000, and something denser than water.
bool looks_like_ct(const GreyLevels& image);

// Converts a grey image to the form that the views need. Takes long, so call it in a background task.
std::shared_ptr<const GreyLevels> levels_of(const GreyVolume& image);

// Returns the image with the default window of its values. Takes long, so call it in a background task.
render::ShownGrey usually_shown(std::shared_ptr<const GreyLevels> image);
// Shows the image with the open body, and stores its path. Throws Error if the open volume and the image do not overlap
// in the world, because no view would show both.
void show_image(Context& context, const render::ShownGrey& shown, const Path& path);
// Returns a document for an image without labels: a volume on the image's grid in which all voxels are air. The user
// can then make labels from the image or paint them.
Document document_for_image(const GreyLevels& image);
void close_image(Context& context);

// Reads the image with which a project was saved, and shows it with the saved settings (`saved`; empty: none were
// saved). If the file is missing, shows a message; the project keeps the file's path.
void reopen_image(Context& context, const Path& path, const std::optional<render::ShownGrey>& saved);

// Stores the posed image of a result, and deletes the posed images of results that no longer exist.
void keep_posed_image(Views& views, PosedImage image);
// Returns the posed image of a result; null if the result has none.
const PosedImage* posed_image_of(const Views& views, const std::shared_ptr<const LabelVolume>& result);

// Returns the value of the image at a world point; empty outside the image.
std::optional<double> image_value_at(const GreyLevels& image, const glm::dvec3& world);
// Returns the value of the grey image under the pointer; empty if there is none. While a result is shown with its posed
// image, this is the posed image's value. Otherwise it is the value of the image at the point's position at rest.
std::optional<double> image_value_at_pointer(const Views& views);
// Returns a value of the shown image as a text: with its unit if the image looks like a CT.
std::string text_of_image_value(const Views& views, double value);

}  // namespace limber::editor
