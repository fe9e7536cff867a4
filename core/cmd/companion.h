// SPDX-License-Identifier: AGPL-3.0-or-later
// The values IN=OUT of --with and --landmarks: a file that is posed together with the volume, and its output file.
#pragma once

#include <string>

namespace limber::cmd {

struct Companion {
  std::string from, to;
};

// Reads IN=OUT. Throws Error if a name is missing.
//   what     names the file in messages        example  an example of the whole option, for messages
Companion companion(const std::string& request, const char* what, const char* example);
Companion grey_paths(const std::string& request);
Companion landmark_paths(const std::string& request);

}  // namespace limber::cmd
