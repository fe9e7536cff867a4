// SPDX-License-Identifier: AGPL-3.0-or-later
// Fuzzes the readers of study descriptions and of score files: they are read into cells that can be computed and scores
// that can be averaged, or refused with Error.
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>

#include <unistd.h>

#include "core/base/error.h"
#include "core/pose/flex_request.h"
#include "core/study/scores.h"
#include "core/study/study.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace limber;
  static const Path path = std::filesystem::temp_directory_path() / ("fuzz-study-" + std::to_string(::getpid()));
  std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    const Study study = read_study(path);
    if (study.poses.empty() || study.techniques.empty() || study.spacings.empty()) std::abort();
    for (const auto& spacing : study.spacings)
      if (spacing && !(*spacing > 0)) std::abort();
    for (const DescribedPose& pose : study.poses)
      for (const std::string& flex : pose.flex) parse_flex_request(flex, "f");
    to_json(study);
  } catch (const Error&) {
  }
  try {
    const RaterScores rater = read_scores(path);
    if (rater.scores.empty() || rater.rater.empty()) std::abort();
    for (const auto& [code, score] : rater.scores)
      if (score.score < kLeastScore || score.score > kMostScore || score.order < 1) std::abort();
  } catch (const Error&) {
  }
  return 0;
}
