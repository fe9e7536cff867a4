// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the results (resampled volumes) that the views show in place of the volume at rest: one result, or the two
// results A and B of a comparison.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/project/document.h"

namespace limber::editor {

struct Context;

// The colours that mark results A and B of a comparison. The letter A or B is always drawn beside the colour.
// In RGB: B07AD9 (A), 3FB6A8 (B); the constants are ABGR.
inline constexpr std::uint32_t kColourOfA = 0xFFD97AB0, kColourOfB = 0xFFA8B63F;
// Returns the result with this name; null if there is none.
std::shared_ptr<const Result> result_named(const Document& document, const std::string& name);
// Returns why no two results can be compared now, as a hint for the user; "" when they can.
std::string why_no_comparison(const Context& context);
// How the views compare two results, which they do only in the Resample workspace. wiping(): true if a line divides
// each view between both results. side_by_side(): true if each view is drawn twice, once for each result.
bool wiping(const Context& context);
bool side_by_side(const Context& context);
bool comparing(const Context& context);  // true if wiping() or side_by_side() is true
// Returns the name that the views show for one side of a comparison: the name of the result, or "At rest" if the
// document has no result of this name.
std::string name_of_side(const Document& document, const std::string& result);

// Returns the result that the views show. Returns null if the views show the volume at rest or the preview of the pose.
// The Rig and Skin workspaces show the body itself. The Pose workspace shows a result only while the current pose is
// the pose from which the result was made.
std::shared_ptr<const Result> shown_result(const Context& context);
// Returns the result that the tables of results describe. This is the result A or B that the user selected to be shown,
// even if the workspace shows something else. If the user has selected none, it is the document's last result.
std::shared_ptr<const Result> chosen_result(const Context& context);

// Returns the volume that the views show: the volume of the shown result, or the document's volume if no result is
// shown. At least one of these volumes must exist.
std::shared_ptr<const LabelVolume> shown_volume(const Context& context);
// Returns a copy of the document that has shown_volume() in place of its own volume.
Document shown_document(const Context& context);

}  // namespace limber::editor
