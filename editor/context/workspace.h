// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

namespace limber::editor {

enum class Workspace { Rig, Skin, Pose, Resample };

}  // namespace limber::editor
