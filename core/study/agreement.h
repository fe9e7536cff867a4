// SPDX-License-Identifier: AGPL-3.0-or-later
// Measures how well raters agree who score the same pictures on an ordinal scale, such as 1 to 5. Both measures are 1
// for full agreement and about 0 for random scores.
#pragma once

#include <optional>
#include <vector>

namespace limber {

// One list of scores for each picture, with one entry for each rater; empty entry: the rater gave no score.
using ScoreTable = std::vector<std::vector<std::optional<int>>>;

// Returns Krippendorff's alpha with the ordinal distance [Krippendorff 2011, Computing Krippendorff's
// alpha-reliability]. There may be any number of raters, and scores may be missing. Returns nothing if no picture has
// two scores, or if all scores are equal.
std::optional<double> krippendorff_alpha(const ScoreTable& scores);

// Returns Cohen's kappa of two raters with quadratic weights [Cohen 1968, Weighted kappa], over the pictures that both
// scored. Returns nothing if there is no such picture, or if random scores would agree fully too.
std::optional<double> weighted_kappa(const ScoreTable& scores, std::size_t rater, std::size_t other);

// Returns the mean of weighted_kappa over all pairs of raters for which it exists; nothing if there is none.
std::optional<double> mean_weighted_kappa(const ScoreTable& scores);

}  // namespace limber
