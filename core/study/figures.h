// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes the pictures of a study's report at its finest spacing: each pose by each technique, and for each technique the
// region that it deforms most.
#pragma once

#include "core/base/progress.h"
#include "core/study/cell_result.h"
#include "core/study/picture.h"

namespace limber {

// A table of pictures, one row for each technique and one column for each pose. A picture is the bytes of a PNG file,
// or empty where there is none.
struct PictureGrid {
  std::vector<std::vector<std::string>> png;
  double width_mm = 0;  // width of the region that each picture shows
};

struct CloseUp {
  const CellResult* cell;
  WorstRegion region;
  std::string tissues, ratio, body;  // bytes of PNG files; body: the body cut open, empty where bodies are not drawn
};

struct StudyFigures {
  int spacing = 0;         // index of the finest spacing in the study's list
  std::vector<int> poses;  // indices of the poses shown, at most kShownPoses of them
  int largest_pose = -1;   // index of the pose with the largest joint rotation; -1: no joint is rotated
  std::string joint;       // the bone whose head the slices pass through; empty: no bone is rotated
  PictureGrid bodies, slices;
  PictureGrid ratios, overlaps;    // pictures of the largest pose alone, so one column
  std::vector<CloseUp> close_ups;  // the most compressed or stretched region first
  std::string no_bodies;           // reason for which no bodies are drawn; empty where they are
};
constexpr int kShownPoses = 6;

// Makes the pictures of a study's report.
//   start  returns what draws bodies in 3D; empty in a program without a renderer
StudyFigures make_figures(const Study& study, const std::vector<CellResult>& cells, const StartPictures& start,
                          Progress& progress);

}  // namespace limber
