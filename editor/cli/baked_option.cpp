// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/cli/baked_option.h"

#include <memory>

#include "core/bake/baked_joint_io.h"
#include "core/base/error.h"
#include "core/deform/bake_source.h"
#include "core/deform/skinning.h"
#include "core/resample/posed_voxels.h"

namespace limber::editor {

void check_baked_files(const std::vector<std::string>& files, const std::string& method) {
  if (!files.empty() && find_blend(method) != Blend::DualQuaternion)
    throw Error("--baked works only with dual quaternions", "--method " + method, "use --method dqs");
  for (const std::string& file : files) read_baked_joint(file);
}

BakedJoints baked_joints_for(const std::vector<std::string>& files, const std::string& method, const Document& document,
                             const TissueVoxels& tissue, const SkinWeights& weights) {
  BakedJoints baked;
  if (files.empty()) return baked;
  check_baked_files(files, method);
  const LabelSet bones = LabelSets(*document.tissues).bone;
  const BakeSource source = bake_source(*document.volume, tissue, bones, *document.armature, weights);
  for (const std::string& file : files) {
    baked.push_back(std::make_shared<const BakedJoint>(read_baked_joint(file)));
    check_source(*baked.back(), source);
  }
  return baked;
}

}  // namespace limber::editor
