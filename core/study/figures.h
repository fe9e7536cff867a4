// SPDX-License-Identifier: AGPL-3.0-or-later
// The pictures of a study's report, at its finest spacing: what each technique makes of each pose, and where it is
// worst.
#pragma once

#include "core/base/progress.h"
#include "core/study/cell_result.h"
#include "core/study/picture.h"

namespace limber {

// Techniques downward, poses across; PNG bytes, empty where there is none.
struct PictureGrid {
  std::vector<std::vector<std::string>> png;
  double width_mm = 0;  // of each picture
};

struct CloseUp {
  const CellResult* cell;
  WorstRegion region;
  std::string tissues, ratio, body;  // PNG bytes; the body cut open, empty where nothing draws it
};

struct StudyFigures {
  int spacing = 0;         // index of the finest
  std::vector<int> poses;  // those shown, at most kShownPoses
  int largest_pose = -1;   // which turns a joint the furthest; -1: none turns any
  std::string joint;       // the bone about whose head slices are cut; empty: none turns
  PictureGrid bodies, slices;
  PictureGrid ratios, overlaps;    // of the largest pose: one column
  std::vector<CloseUp> close_ups;  // worst first
  std::string no_bodies;           // why there are no bodies, empty where there are
};
constexpr int kShownPoses = 6;

//   start  none: a program that cannot draw
StudyFigures make_figures(const Study& study, const std::vector<CellResult>& cells, const StartPictures& start,
                          Progress& progress);

}  // namespace limber
