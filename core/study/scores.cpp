// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/scores.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/base/text_parse.h"
#include "core/study/agreement.h"
#include "core/study/text.h"
#include "core/tissue/tissue_match.h"

namespace limber {

namespace {

constexpr std::uint64_t kLargestFile = 16 << 20;
constexpr std::size_t kMostScores = 100000, kLongestName = 200;
constexpr char kColumns[] = "study,rater,order,picture,score,remark";

[[noreturn]] void refuse(const Path& path, int line, const std::string& what, const std::string& what_to_do) {
  throw Error(what, path.string() + ", line " + std::to_string(line), what_to_do);
}

int whole_number(const std::string& text, int least, int most, const Path& path, int line, const char* name) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < least || value > most)
    refuse(path, line, std::string("the ") + name + " is not valid",
           "write a whole number from " + std::to_string(least) + " to " + std::to_string(most));
  return value;
}

void read_row(const std::vector<std::string>& fields, int line, RaterScores& rater) {
  const Path& path = rater.file;
  if (fields.size() != 6)
    refuse(path, line, "the row does not have six fields", std::string("keep the columns ") + kColumns);
  const std::string &name = fields[1], &code = fields[3];
  if (name.empty() || name.size() > kLongestName)
    refuse(path, line, "the rater has no name", "write the rater's name or number in the second column");
  if (rater.rater.empty()) rater.rater = name;
  if (rater.rater != name) refuse(path, line, "the file names two raters", "use one file for each rater");
  if (code.empty() || code.size() > kLongestName)
    refuse(path, line, "the row has no code of a picture, or one that is too long",
           "keep the codes that rating.html wrote");
  if (fields[4].empty()) return;
  const RaterScores::Score score{whole_number(fields[2], 1, 1 << 20, path, line, "order"),
                                 whole_number(fields[4], kLeastScore, kMostScore, path, line, "score"), fields[5]};
  if (!rater.scores.emplace(code, score).second)
    refuse(path, line, "the picture is scored twice", "leave out one of the two rows");
  if (rater.scores.size() > kMostScores)
    refuse(path, line, "the file has too many scores", "use the file that rating.html saved");
}

TechniqueScore technique_score(const std::vector<double>& scores) {
  TechniqueScore result{.scores = static_cast<int>(scores.size())};
  if (scores.empty()) return result;
  for (const double score : scores) result.mean += score / double(scores.size());
  double squares = 0;
  for (const double score : scores) squares += (score - result.mean) * (score - result.mean);
  if (scores.size() > 1) result.deviation = std::sqrt(squares / double(scores.size() - 1));
  return result;
}

}  // namespace

RaterScores read_scores(const Path& path) {
  const std::string text = read_file(path, kLargestFile);
  RaterScores rater{.file = path};
  int line = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view row = trimmed(std::string_view(text).substr(begin, end - begin));
    begin = end + 1;
    ++line;
    if (line == 1 && row != kColumns && row != std::string("\xef\xbb\xbf") + kColumns)
      throw Error("this is not a file of scores", path.string(),
                  "use a file that rating.html saved, with the columns " + std::string(kColumns));
    if (line > 1 && !row.empty()) read_row(csv_fields(row), line, rater);
  }
  if (rater.scores.empty()) throw Error("the file has no scores", path.string(), "score the pictures of rating.html");
  return rater;
}

RatingResult rate(const Study& study, const std::vector<RatedPicture>& pictures,
                  const std::vector<RaterScores>& raters) {
  RatingResult result{.pictures = pictures.size(),
                      .csv = "rater,order,picture,spacing_mm,pose,method,score,remark\r\n"};
  std::map<std::string, std::size_t> index;
  for (std::size_t i = 0; i < pictures.size(); ++i) index[pictures[i].code] = i;
  ScoreTable table(pictures.size(), std::vector<std::optional<int>>(raters.size()));
  std::vector<std::vector<double>> of_technique(study.techniques.size());
  for (std::size_t r = 0; r < raters.size(); ++r) {
    if (std::count(result.raters.begin(), result.raters.end(), raters[r].rater))
      throw Error("two files are of the rater " + raters[r].rater, raters[r].file.string(),
                  "leave out one of the two files");
    result.raters.push_back(raters[r].rater);
    for (const auto& [code, score] : raters[r].scores) {
      const auto found = index.find(code);
      if (found == index.end())
        throw Error("the picture " + code + " is not of this study", raters[r].file.string(),
                    "use the study and the version of Limber that made the form");
      const StudyCell& cell = pictures[found->second].cell->cell;
      table[found->second][r] = score.score;
      of_technique[std::size_t(cell.technique)].push_back(score.score);
      const auto& spacing = study.spacings[std::size_t(cell.spacing)];
      for (const std::string& field :
           {raters[r].rater, std::to_string(score.order), code, spacing ? number(*spacing) : "",
            study.poses[std::size_t(cell.pose)].name, word_of(study.techniques[std::size_t(cell.technique)]),
            std::to_string(score.score)})
        result.csv += csv_field(field) + ",";
      result.csv += csv_field(score.remark) + "\r\n";
    }
  }
  for (const auto& scores : of_technique) result.techniques.push_back(technique_score(scores));
  result.alpha = krippendorff_alpha(table);
  result.kappa = mean_weighted_kappa(table);
  return result;
}

}  // namespace limber
