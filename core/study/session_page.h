// SPDX-License-Identifier: AGPL-3.0-or-later
// Results that were made one by one, as the page that studies have (html_report.h): their figures, pictures, gates and
// provenance, pose by technique. A result of finite elements has the volume ratio of its mesh, one with its overlap
// kept a map of that.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/project/document.h"
#include "core/study/picture.h"

namespace limber {

struct SessionResult {
  std::shared_ptr<const Result> result;
  std::string pose;  // its name: results of one pose stand in one row
};

struct SessionPage {
  std::string name;                    // of the project
  std::vector<SessionResult> results;  // at least one
  std::shared_ptr<const TissueTable> tissues;
};

//   scratch  an empty folder, which is left with what the page was made from
//   start    draws bodies in 3D, or none
//   throws Error where a result's report is damaged or the folder cannot be written
std::string session_page(const SessionPage& session, const Path& scratch, const StartPictures& start,
                         Progress& progress);

}  // namespace limber
