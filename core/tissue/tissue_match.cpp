// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/tissue/tissue_match.h"

#include <algorithm>
#include <cstdint>

#include "core/base/error.h"
#include "core/base/text_parse.h"

namespace limber {

namespace {
std::vector<std::string> parts_of(std::string_view text) {
  std::vector<std::string> parts;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('|'), text.size());
    const auto part = trimmed(text.substr(0, end));
    if (!part.empty()) parts.emplace_back(part);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return parts;
}

// Returns a bit for each letter, 'a' the lowest, that a word of the name begins with.
std::uint32_t first_letters(const TissueWords& words) {
  std::uint32_t letters = 0;
  for (const std::string& word : words) letters |= std::uint32_t{1} << (word.front() - 'a');
  return letters;
}

// Returns the number of words of name i of a row (i = 0: the row's name, then its synonyms) if the tissue's name
// contains all of these words; else 0.
//   letters  first_letters(name), which quickly excludes most rows
int words_met(const TissueWords& name, std::uint32_t letters, const TissueNames& row, std::size_t i) {
  const TissueWords& wanted = row.words[i];
  if (row.whole[i] && name.size() != wanted.size()) return 0;
  const auto is_there = [&](const std::string& word) {
    return (letters >> (word.front() - 'a') & 1) && has_word(name, word);
  };
  const bool all = std::all_of(wanted.begin(), wanted.end(), is_there);
  return all ? static_cast<int>(wanted.size()) : 0;
}

bool is_bone_kind(TissueKind kind) {
  return kind == TissueKind::Bone || kind == TissueKind::CorticalBone || kind == TissueKind::CancellousBone;
}
}  // namespace

TissueWords words_in_tissue_name(std::string_view name) {
  TissueWords words;
  std::string word;
  const auto end_word = [&] {
    if (!word.empty()) words.insert(word);
    word.clear();
  };
  char before = ' ';
  for (char c : name.substr(0, 400)) {
    const bool upper = c >= 'A' && c <= 'Z', lower = c >= 'a' && c <= 'z';
    if (!upper && !lower) end_word();
    if (upper && before >= 'a' && before <= 'z') end_word();
    if (upper || lower) word += upper ? static_cast<char>(c - 'A' + 'a') : c;
    before = c;
  }
  end_word();
  return words;
}

bool has_word(const TissueWords& words, std::string_view word) {
  return words.contains(word) || (word.size() > 2 && words.contains(std::string(word) + "s"));
}

TissueMatch match_tissue(const Tissue& tissue, std::span<const TissueNames> rows) {
  return match_tissue(tissue, rows.size(), [&](std::size_t row) -> const TissueNames& { return rows[row]; });
}

TissueMatch match_tissue(const Tissue& tissue, std::size_t rows,
                         const std::function<const TissueNames&(std::size_t)>& names_of) {
  const TissueWords name = words_in_tissue_name(tissue.name);
  const std::uint32_t letters = first_letters(name);
  TissueMatch best;
  int best_score = 0;
  for (std::size_t row = 0; row < rows; ++row) {
    const TissueNames& names = names_of(row);
    if (names.is_bone && tissue.kind == TissueKind::Muscle) continue;
    const bool same_kind = std::find(names.kinds.begin(), names.kinds.end(), tissue.kind) != names.kinds.end();
    int words = 0;
    std::size_t found = 0;
    for (std::size_t i = 0; i < names.words.size(); ++i)
      if (const int met = words_met(name, letters, names, i); met > words) words = met, found = i;
    const int score = words > 0 ? 2 * words + 1 + same_kind : same_kind;
    if (score > best_score) {
      best_score = score;
      best = {static_cast<int>(row), words > 0, words == 0 ? "" : found == 0 ? names.name : names.synonyms[found - 1]};
    }
  }
  return best;
}

std::vector<std::string> csv_fields(std::string_view line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"') fields.back() += line[++i];
    else if (c == '"') quoted = !quoted;
    else if (c == ',' && !quoted) fields.emplace_back();
    else fields.back() += c;
  }
  for (std::string& field : fields) field = std::string(trimmed(field));
  return fields;
}

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c == '\n' || c == '\r' ? ' ' : c;
  }
  return quoted + "\"";
}

TissueNames tissue_names_of(const std::vector<std::string>& fields, const std::string& where) {
  TissueNames names{.name = fields.at(0), .synonyms = parts_of(fields.at(1)), .kinds = {}, .words = {}};
  if (names.name.empty()) throw Error("the row has no name", where, "name the tissue in its first field");
  for (const std::string& text : parts_of(fields.at(2))) {
    const auto kind = tissue_kind_from_text(text);
    if (!kind)
      throw Error("unknown kind " + in_quotes(text), where,
                  "use skin, fat, muscle, bone, cartilage, tendon, vessel, nerve, organ ...");
    names.kinds.push_back(*kind);
  }
  names.words.push_back(words_in_tissue_name(names.name));
  names.whole.push_back(false);
  for (std::string& synonym : names.synonyms) {
    names.whole.push_back(synonym.starts_with('='));
    if (names.whole.back()) synonym.erase(0, 1);
    names.words.push_back(words_in_tissue_name(synonym));
  }
  names.is_bone = is_bone_kind(tissue_kind_from_name(names.name));
  return names;
}

}  // namespace limber
