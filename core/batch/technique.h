// SPDX-License-Identifier: AGPL-3.0-or-later
// The techniques (ways of posing) that studies and batches compare, and their names.
#pragma once

#include <string>
#include <vector>

#include "core/resample/deformation_method.h"

namespace limber {

// A technique (way of posing) that a study or batch compares. It is a deformation method
// (resample/deformation_method.h) and, for finite elements, says whether contact is simulated. A method followed by the
// correction that makes masses exact is a technique of its own, so that reports distinguish the two.
struct Technique {
  std::string method;    // "dqs": a word of deformation_methods()
  bool contact = false;  // true: contact is simulated; only for finite elements
  bool mass_exact = false;

  bool is_fem() const { return method == kFiniteElements; }
  Technique plain() const { return {method, contact, false}; }
  bool operator==(const Technique&) const = default;
};
// Returns all techniques without the correction that keeps the volume of each soft tissue.
std::vector<Technique> plain_techniques();
std::string technique_words();  // returns the words of plain_techniques(): "mix, lbs, dqs, fem, fem-contact"
// Returns the word for a technique in descriptions, folder names and tables, such as "fem-contact", "fem-mass-exact".
std::string word_of(const Technique& technique);
std::string title_of(const Technique& technique);  // returns text such as "FEM with contact", "FEM, mass-exact"
// Returns the techniques with the given words ("lbs", "fem-contact"). Throws Error for a word that is unknown or occurs
// twice; `where` names the source of the words in the message.
std::vector<Technique> techniques_of(const std::vector<std::string>& words, const std::string& where);

}  // namespace limber
