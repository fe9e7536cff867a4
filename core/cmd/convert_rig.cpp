// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/cmd/convert_rig.h"

#include <algorithm>

#include "core/cmd/command.h"
#include "core/motion/bvh.h"
#include "core/rig_io/rig_io.h"

namespace limber::cmd {

namespace {
std::string extension_of(const Path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension;
}
}  // namespace

void convert_rig_or_motion(const Path& in, const Path& out) {
  check_armature_writable(out);
  if (extension_of(in) == ".bvh" && extension_of(out) == ".bvh") {
    const Motion motion = read_bvh(in);
    warn(motion.warnings);
    return write_bvh(motion, out);
  }
  const ArmatureFile rig = read_armature_file(in);
  warn(rig.warnings);
  write_armature(rig.armature, out);
}

}  // namespace limber::cmd
