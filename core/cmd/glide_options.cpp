// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/cmd/glide_options.h"

namespace limber::cmd {

void add_glide_option(CLI::App& command, std::string& glide) {
  command
      .add_option(
          "--glide", glide,
          "largest shift of joints whose bones would overlap: joint (5 percent of the shorter bone), voxel (no "
          "bone moves further than one voxel), a length in mm, or off (default: joint; with --pose or --motion: "
          "voxel)")
      ->type_name("off|voxel|joint|MM");
}

std::string glide_word(const std::string& glide, const PoseOptions& pose) {
  if (!glide.empty()) return glide;
  const bool says_where_bones_stand = !pose.pose.empty() || !pose.motion.empty();
  return says_where_bones_stand ? "voxel" : "joint";
}

}  // namespace limber::cmd
