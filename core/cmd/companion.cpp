// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/cmd/companion.h"

#include "core/base/error.h"

namespace limber::cmd {

Companion companion(const std::string& request, const char* what, const char* example) {
  const size_t equals = request.rfind('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == request.size())
    throw Error(std::string("this does not name a ") + what + " and its output file", request,
                std::string("write IN=OUT, as in ") + example);
  return {request.substr(0, equals), request.substr(equals + 1)};
}

Companion grey_paths(const std::string& request) {
  return companion(request, "grey volume", "--with ct.nii.gz=posed-ct.nii.gz");
}

Companion landmark_paths(const std::string& request) {
  return companion(request, "list of landmarks", "--landmarks points.csv=posed-points.csv");
}

}  // namespace limber::cmd
