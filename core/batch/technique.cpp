// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/batch/technique.h"

#include <algorithm>

#include "core/base/error.h"

namespace limber {

namespace {
constexpr const char* kExactWord = "-mass-exact";
}

std::vector<Technique> plain_techniques() {
  std::vector<Technique> all;
  for (const DeformationMethod& method : deformation_methods()) all.push_back({method.word});
  all.push_back({std::string(kFiniteElements), true});
  return all;
}

std::string technique_words() {
  std::string words;
  for (const Technique& technique : plain_techniques()) words += (words.empty() ? "" : ", ") + word_of(technique);
  return words;
}

std::string word_of(const Technique& technique) {
  return technique.method + (technique.contact ? "-contact" : "") + (technique.mass_exact ? kExactWord : "");
}
std::string title_of(const Technique& technique) {
  return find_method(technique.method)->name + (technique.contact ? " with contact" : "") +
         (technique.mass_exact ? ", mass-exact" : "");
}

std::vector<Technique> techniques_of(const std::vector<std::string>& words, const std::string& where) {
  std::vector<Technique> known = plain_techniques();
  for (const Technique& technique : plain_techniques()) known.push_back({technique.method, technique.contact, true});

  std::vector<Technique> techniques;
  for (const std::string& word : words) {
    const auto found =
        std::find_if(known.begin(), known.end(), [&](const Technique& one) { return word_of(one) == word; });
    if (found == known.end())
      throw Error("there is no such method: " + word, where,
                  "use " + technique_words() + ", or one of these with " + kExactWord + " at its end");
    if (std::count(techniques.begin(), techniques.end(), *found))
      throw Error("a value occurs twice", where, "name each value once");
    techniques.push_back(*found);
  }
  return techniques;
}

}  // namespace limber
