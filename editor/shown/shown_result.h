// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the result (a resampled volume) that the views show in place of the volume at rest, and the result that it is
// compared with.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "editor/context/editor.h"

namespace limber::editor {

// The colours that mark results A and B of a comparison. They are always shown together with the letter.
inline constexpr std::uint32_t kColourOfA = 0xFFD97AB0, kColourOfB = 0xFFA8B63F;  // RRGGBB: B07AD9, 3FB6A8
std::shared_ptr<const Result> result_named(const Document& document, const std::string& name);  // null for none
// Returns why no two results can be compared now, as a hint for the user; "" when they can.
std::string why_no_comparison(const Editor& editor);
// wiping() returns whether the views are divided by a line to compare two results; side_by_side(), whether each view is
// shown twice for that. Results are compared only in the Resample workspace.
bool wiping(const Editor& editor);
bool side_by_side(const Editor& editor);
bool comparing(const Editor& editor);  // wiping() or side_by_side()
// Returns the name that the views show for the result with this name: the name itself, or "At rest" if there is no such
// result.
std::string name_of_side(const Editor& editor, const std::string& result);

// Returns the result that the views show. Null if they show the volume at rest or its preview in the pose. In the Pose
// workspace, a result is shown only while the current pose is the one that the result was made from.
std::shared_ptr<const Result> shown_result(const Editor& editor);
// Returns the result that the tables of results describe: the one that the views show, else the last one.
std::shared_ptr<const Result> chosen_result(const Editor& editor);

// Returns the volume that the views show: that of the shown result, else the document's. One of them must exist.
std::shared_ptr<const LabelVolume> shown_volume(const Editor& editor);
// Returns a copy of the document that has shown_volume() in place of its own volume.
Document shown_document(const Editor& editor);

}  // namespace limber::editor
