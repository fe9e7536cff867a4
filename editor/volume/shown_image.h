// SPDX-License-Identifier: AGPL-3.0-or-later
// The grey image (CT, MR) that the views show with the labels (Views::image): opening and closing it, and the windows
// of values in which it is looked at. The image is no part of the document: the project stores the place of its file,
// and reads it again when it is opened.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "core/volume/grey_levels.h"
#include "core/volume_io/volume_io.h"
#include "editor/context/editor.h"

namespace limber::editor {

// A window of values, as radiologists use for CT, in Hounsfield units.
struct ImageWindow {
  const char *id, *name;
  double level, width;
};
std::span<const ImageWindow> ct_windows();

// Returns true if the values look like Hounsfield units: air at about -1000, and something denser than water.
bool looks_like_ct(const GreyLevels& image);

// Returns the values of a grey image as the views need them. Meant for tasks.
std::shared_ptr<const GreyLevels> levels_of(const GreyVolume& image);

// Shows the image with the open body, in the usual window of its values, and remembers the file. Throws Error if the
// open volume and the image lie beside each other, so that no view would show both.
void show_image(Editor& editor, std::shared_ptr<const GreyLevels> image, const Path& path);
// Returns a document for a bare image: a volume on the image's grid in which everything is air, so that labels can be
// made from the image or painted.
Document document_for_image(const GreyLevels& image);
void close_image(Editor& editor);

// Reads the image again that a project was saved with, and shows it as it was shown then (`shown`; empty: unknown). If
// the file is gone, a message says so, and the project goes on naming it.
void reopen_image(Editor& editor, const Path& path, const std::optional<render::ShownGrey>& shown);

// Keeps the posed image of a result, and drops those of results that are gone.
void keep_posed_image(Views& views, PosedImage image);
// Returns the posed image of a result; null if it was made without one.
const PosedImage* posed_image_of(const Views& views, const std::shared_ptr<const LabelVolume>& result);

// Returns the value of the image at a world point; empty outside the image.
std::optional<double> image_value_at(const GreyLevels& image, const glm::dvec3& world);

}  // namespace limber::editor
