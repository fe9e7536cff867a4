// SPDX-License-Identifier: AGPL-3.0-or-later
// The option --baked of `limber render`: files of baked joints, which `limber bake-joint` writes. A baked joint stores
// how the flesh around a joint differs between finite elements and blending by dual quaternions.
#pragma once

#include <string>
#include <vector>

#include "core/project/document.h"
#include "core/resample/baked_pose.h"

namespace limber::editor {

// Throws Error if a file is not a baked joint, and if there are files but the method is not dual quaternions. Checks
// this even if no pose uses the files.
void check_baked_files(const std::vector<std::string>& files, const std::string& method);

// Reads the files of baked joints. Throws Error if a file is not a baked joint or was baked from another body, and if
// the method is not dual quaternions.
BakedJoints baked_joints_for(const std::vector<std::string>& files, const std::string& method, const Document& document,
                             const TissueVoxels& tissue, const SkinWeights& weights);

}  // namespace limber::editor
