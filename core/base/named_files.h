// SPDX-License-Identifier: AGPL-3.0-or-later
// Files that a command names, and whether two names stand for one file: by device and inode where the file exists, so
// that symbolic and hard links are seen through, else by the place that the name leads to.
#pragma once

#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/file.h"

namespace limber {

// What was asked for contradicts itself, whatever the files hold: the command line's exit code is 2.
class UsageError : public Error {
 public:
  using Error::Error;
};

struct NamedFile {
  std::string named_by;  // the option or the word, as in "--report"
  Path path;
};

// Throws UsageError when an output is also an input, lies as a file in a folder that is an input, or is another output.
// What is no regular file (a device, a pipe) may be named twice: nothing is lost by writing to it.
void check_apart(const std::vector<NamedFile>& inputs, const std::vector<NamedFile>& outputs);

}  // namespace limber
