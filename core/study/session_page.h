// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes the results of an editor session as one HTML page, in the form of a study's page (html_report.h): figures,
// pictures, quality gates and provenance, by pose and technique. For results of finite elements the page also shows the
// volume ratios in the mesh. For results that store their overlap it also shows a picture of the overlap.
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
  std::string pose;  // name of the pose; results of the same pose are shown in one row
};

struct SessionPage {
  std::string name;                    // name of the project
  std::vector<SessionResult> results;  // results on the page, at least one
  std::shared_ptr<const TissueTable> tissues;
};

// Returns the page as HTML. Throws Error if a result's report is damaged or the folder cannot be written.
//   scratch  an empty folder for the files from which the page is made; they stay there
//   start    returns the function that draws bodies in 3D; may be empty
std::string session_page(const SessionPage& session, const Path& scratch, const StartPictures& start,
                         Progress& progress);

}  // namespace limber
