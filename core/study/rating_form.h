// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes a form on which raters score how real the posed bodies look, without knowing which technique posed them. The
// form is one HTML page that works offline. It shows each bent pose by each technique at the finest spacing, in an
// order that is shuffled for each rater, and saves the scores as a CSV file (scores.h). A separate file, the key, says
// which pose and technique each picture shows.
#pragma once

#include <string>
#include <vector>

#include "core/study/figures.h"

namespace limber {

struct RatedPicture {
  std::string code;  // name of the picture in form and scores; tells nothing about technique or pose
  const CellResult* cell;
  std::string body, slice;  // bytes of PNG files; `body` is empty if bodies are not drawn
};

constexpr int kLeastScore = 1, kMostScore = 5;

// Returns the pictures to score, sorted by code. A cell has the same code in all runs that give the same result.
std::vector<RatedPicture> rated_pictures(const Study& study, const std::vector<CellResult>& cells,
                                         const StudyFigures& figures);

// Returns the form as HTML.
//   legend  the tissues that the cuts show, with their colours
std::string rating_form(const Study& study, const std::vector<RatedPicture>& pictures, const TissueLegend& legend);

// Returns the key of the form as CSV with the columns picture, spacing_mm, pose and method.
std::string rating_key(const Study& study, const std::vector<RatedPicture>& pictures);

}  // namespace limber
