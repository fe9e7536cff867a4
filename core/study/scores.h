// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads the scores that raters gave on the form (rating_form.h). Computes for each technique the mean score of its
// bodies, and how well the raters agree. A rater's file is CSV with the columns study, rater, order, picture, score and
// remark; a picture without a score has an empty field.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/study/rating_form.h"

namespace limber {

struct RaterScores {
  struct Score {
    int order = 0;  // position at which the rater saw the picture, from 1
    int score = 0;  // the rater's score, from 1 to 5
    std::string remark;
  };
  Path file;
  std::string rater;
  std::map<std::string, Score> scores;  // keyed by the picture's code; pictures without a score have no entry
};

// Reads a rater's file. Throws Error if the file is not of this kind, names two raters, or has an invalid score.
RaterScores read_scores(const Path& path);

struct TechniqueScore {
  int scores = 0;                  // number of scores of all raters and poses
  double mean = 0, deviation = 0;  // mean and standard deviation of the scores
};

struct RatingResult {
  std::vector<std::string> raters;
  std::size_t pictures = 0;                // number of pictures on the form
  std::vector<TechniqueScore> techniques;  // in the order of the study
  std::optional<double> alpha;             // Krippendorff's alpha with the ordinal distance
  std::optional<double> kappa;             // Cohen's kappa with quadratic weights, mean over all pairs of raters
  std::string csv;  // table with one row for each score: rater, order, picture, spacing_mm, pose, method, score, remark
};

// Finds the technique of each scored picture. Throws Error if a file scores a picture that is not of this study, or if
// two files are by the same rater.
RatingResult rate(const Study& study, const std::vector<RatedPicture>& pictures,
                  const std::vector<RaterScores>& raters);

}  // namespace limber
