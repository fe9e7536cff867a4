// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes a form on which raters score how real the posed bodies look, without knowing which technique posed them. The
// form is one HTML page that works offline. It shows each bent pose by each technique at the finest spacing, in an
// order that is shuffled for each rater, and saves the scores as a CSV file (scores.h). Only the key, a file of its
// own, says which picture is whose.
#pragma once

#include <string>
#include <vector>

#include "core/study/figures.h"

namespace limber {

struct RatedPicture {
  std::string code;  // what form and scores call the picture; says nothing about technique or pose
  const CellResult* cell;
  std::string body, slice;  // bytes of PNG files; `body` is empty if bodies are not drawn
};

constexpr int kLeastScore = 1, kMostScore = 5;

// Returns the pictures to score, sorted by code. A cell has the same code in all runs that give its result.
std::vector<RatedPicture> rated_pictures(const Study& study, const std::vector<CellResult>& cells,
                                         const StudyFigures& figures);

//   legend  the tissues that the cuts show
std::string rating_form(const Study& study, const std::vector<RatedPicture>& pictures, const TissueLegend& legend);

// Returns CSV with the columns picture, spacing_mm, pose and method.
std::string rating_key(const Study& study, const std::vector<RatedPicture>& pictures);

}  // namespace limber
