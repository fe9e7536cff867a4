// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes the results that were made in an editor session as the same page that studies have (html_report.h): their
// figures, pictures, gates and provenance, by pose and technique. For a result of finite elements the page shows the
// volume ratio of its mesh. For a result that kept its overlap it shows a picture of the overlap.
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
  std::string pose;  // name of the pose; results of one pose share a row
};

struct SessionPage {
  std::string name;                    // name of the project
  std::vector<SessionResult> results;  // at least one
  std::shared_ptr<const TissueTable> tissues;
};

// Returns the page as HTML. Throws Error where a result's report is damaged or the folder cannot be written.
//   scratch  an empty folder, which keeps the files that the page was made from
//   start    returns what draws bodies in 3D; may be empty
std::string session_page(const SessionPage& session, const Path& scratch, const StartPictures& start,
                         Progress& progress);

}  // namespace limber
