// SPDX-License-Identifier: AGPL-3.0-or-later
// The result that the views show in place of the volume at rest, and the one it is compared with.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "editor/context/editor.h"

namespace limber::editor {

// Where it is told by colour who is who, always with its letter.
inline constexpr std::uint32_t kColourOfA = 0xFFD97AB0, kColourOfB = 0xFFA8B63F;  // B07AD9, 3FB6A8, as ImGui packs them
std::shared_ptr<const Result> result_named(const Document& document, const std::string& name);  // null for none
// Why there is nothing to compare; "" when there is.
std::string why_no_comparison(const Editor& editor);
// In the Resample workspace alone: elsewhere there is work on one body.
bool wiping(const Editor& editor);
bool side_by_side(const Editor& editor);
bool comparing(const Editor& editor);  // either
// Name of a side as the views show it: "Fore 30°, DQ", "At rest".
std::string name_of_side(const Editor& editor, const std::string& result);

// The result that is seen in the views in place of the volume; null: the volume at rest, or as it follows the pose.
// Where poses are made a result stands back as soon as the pose is another than its own.
std::shared_ptr<const Result> shown_result(const Editor& editor);
// The one the tables are about: the shown one, else the last.
std::shared_ptr<const Result> chosen_result(const Editor& editor);

// The grid and tissue of what the views show. Needs a volume.
std::shared_ptr<const LabelVolume> shown_volume(const Editor& editor);
// The document with that volume in place of its own.
Document shown_document(const Editor& editor);

}  // namespace limber::editor
