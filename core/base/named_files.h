// SPDX-License-Identifier: AGPL-3.0-or-later
// Checks whether two file names of a command mean the same file. Existing files are compared by device and inode, so
// that symbolic and hard links are recognized, others by the resolved path.
#pragma once

#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/file.h"

namespace limber {

// Error of a command whose arguments contradict each other, whatever the files contain. The command line then ends with
// exit code 2.
class UsageError : public Error {
 public:
  using Error::Error;
};

struct NamedFile {
  std::string named_by;  // the option or argument that names the file, as in "--report"
  Path path;
};

// Throws UsageError when an output file is also an input, lies in a folder that is an input, or is also another output.
// A file that is not regular (a device, a pipe) may be named twice: writing to it destroys nothing.
void check_apart(const std::vector<NamedFile>& inputs, const std::vector<NamedFile>& outputs);

}  // namespace limber
