// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/agreement.h"

#include <algorithm>
#include <map>

namespace limber {

namespace {

double squared(double value) { return value * value; }

// Returns the squared ordinal distance of the scores c and k: the number of scores with a value from c to k, where
// those equal to c or k count half.
double ordinal_distance(const std::map<int, double>& given, int c, int k) {
  double between = 0;
  for (auto at = given.lower_bound(std::min(c, k)); at != given.end() && at->first <= std::max(c, k); ++at)
    between += at->second;
  return squared(between - (given.at(c) + given.at(k)) / 2);
}

}  // namespace

std::optional<double> krippendorff_alpha(const ScoreTable& scores) {
  // Number of coincidences of the values c and k: in a picture with m scores, each ordered pair of scores adds 1 / (m -
  // 1).
  std::map<std::pair<int, int>, double> coincidences;
  std::map<int, double> given;
  double all = 0;
  for (const auto& picture : scores) {
    std::map<int, double> count;
    double m = 0;
    for (const std::optional<int>& score : picture)
      if (score) count[*score] += 1, m += 1;
    if (m < 2) continue;
    all += m;
    for (const auto& [c, of_c] : count) {
      given[c] += of_c;
      for (const auto& [k, of_k] : count) coincidences[{c, k}] += of_c * (of_k - (c == k)) / (m - 1);
    }
  }
  double observed = 0, expected = 0;
  for (const auto& [pair, number] : coincidences) observed += number * ordinal_distance(given, pair.first, pair.second);
  for (const auto& [c, of_c] : given)
    for (const auto& [k, of_k] : given) expected += of_c * of_k * ordinal_distance(given, c, k);
  if (expected == 0) return {};
  return 1 - (all - 1) * observed / expected;
}

std::optional<double> weighted_kappa(const ScoreTable& scores, std::size_t rater, std::size_t other) {
  std::map<int, double> of_rater, of_other;
  double both = 0, observed = 0, expected = 0;
  for (const auto& picture : scores) {
    if (!picture[rater] || !picture[other]) continue;
    both += 1;
    of_rater[*picture[rater]] += 1;
    of_other[*picture[other]] += 1;
    observed += squared(*picture[rater] - *picture[other]);
  }
  for (const auto& [a, of_a] : of_rater)
    for (const auto& [b, of_b] : of_other) expected += of_a * of_b / both * squared(a - b);
  if (expected == 0) return {};
  return 1 - observed / expected;
}

std::optional<double> mean_weighted_kappa(const ScoreTable& scores) {
  double sum = 0;
  int pairs = 0;
  const std::size_t raters = scores.empty() ? 0 : scores.front().size();
  for (std::size_t a = 0; a < raters; ++a)
    for (std::size_t b = a + 1; b < raters; ++b)
      if (const auto kappa = weighted_kappa(scores, a, b)) sum += *kappa, ++pairs;
  return pairs ? std::optional(sum / pairs) : std::nullopt;
}

}  // namespace limber
