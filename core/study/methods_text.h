// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes how the results of a study were made, for the methods section of a paper: the algorithms with their
// references, and the parameters that the cells' reports state. Methods that the study did not use are not mentioned.
#pragma once

#include <string>
#include <vector>

#include "core/study/cell_result.h"

namespace limber {

struct MethodsText {
  std::string paragraphs, references;  // HTML: <p> elements, and the <li> elements of a numbered list
};

// Returns the text on the methods of a study.
//   of_session  true: the results are of an editor session, whose weights and repeats are not known
MethodsText methods_text(const Study& study, const std::vector<CellResult>& cells, bool of_session);

}  // namespace limber
