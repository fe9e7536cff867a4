// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads the scores that raters gave on the form (rating_form.h), and finds for each technique how real its bodies look
// and how well the raters agree. A rater's file is CSV with the columns study, rater, order, picture, score and remark;
// a picture without a score has an empty field.
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
    int score = 0;  // [1, 5]
    std::string remark;
  };
  Path file;
  std::string rater;
  std::map<std::string, Score> scores;  // by the picture's code; only pictures with a score
};

// Reads a rater's file. Throws Error if it is no such file, names two raters, or has a wrong score.
RaterScores read_scores(const Path& path);

struct TechniqueScore {
  int scores = 0;                  // number of scores of all raters and poses
  double mean = 0, deviation = 0;  // mean and standard deviation
};

struct RatingResult {
  std::vector<std::string> raters;
  std::size_t pictures = 0;                // number of pictures on the form
  std::vector<TechniqueScore> techniques;  // in the order of the study
  std::optional<double> alpha;             // Krippendorff's, ordinal
  std::optional<double> kappa;             // Cohen's with quadratic weights, mean over all pairs of raters
  std::string csv;                         // tidy: rater, order, picture, spacing_mm, pose, method, score, remark
};

// Finds the technique of each scored picture. Throws Error if a file scores a picture that is not of this study, or two
// files are of one rater.
RatingResult rate(const Study& study, const std::vector<RatedPicture>& pictures,
                  const std::vector<RaterScores>& raters);

}  // namespace limber
