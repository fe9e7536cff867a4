// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes the pictures of a study's report, at the study's finest spacing: one for each pose and technique, and for each
// technique a close-up of the region that it deforms most.
#pragma once

#include "core/base/progress.h"
#include "core/study/cell_result.h"
#include "core/study/picture.h"
#include "core/study/tissue_legend.h"

namespace limber {

// A table of pictures, with one row for each technique and one column for each pose. Each picture is stored as the
// bytes of a PNG file, empty if there is no picture.
struct PictureGrid {
  std::vector<std::vector<std::string>> png;
  double width_mm = 0;  // width of the region that each picture shows
  TissueLegend legend;  // the tissues that the pictures show
};

struct CloseUp {
  const CellResult* cell;
  WorstRegion region;
  std::string tissues, ratio, body;  // bytes of PNG files; `body` shows the body cut open, empty: not drawn
};

struct StudyFigures {
  int spacing = 0;         // index of the finest spacing in the study's list
  std::vector<int> poses;  // indices of the poses shown, at most kShownPoses of them
  int largest_pose = -1;   // index of the pose with the largest joint rotation; -1: no joint is rotated
  std::string joint;       // name of the bone through whose head the slices pass; empty: no bone is rotated
  PictureGrid bodies, slices;
  PictureGrid ratios, overlaps;    // one column each, which shows the pose with the largest joint rotation
  std::vector<CloseUp> close_ups;  // sorted: the most compressed or stretched region first
  TissueLegend close_up_legend;
  std::string no_bodies;  // why there are no 3D pictures of bodies; "" if there are
};
constexpr int kShownPoses = 6;

// Makes the pictures of a study's report.
//   start  returns the function that draws bodies in 3D; empty in a program without a renderer
StudyFigures make_figures(const Study& study, const std::vector<CellResult>& cells, const StartPictures& start,
                          Progress& progress);

}  // namespace limber
