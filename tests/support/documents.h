// SPDX-License-Identifier: AGPL-3.0-or-later
// Small documents with every part, random edits of them as operators would make, and comparison by contents.
#pragma once

#include <cstdint>
#include <random>

#include "core/project/document.h"

namespace limber::test {

// A bar of 24 x 10 x 9 voxels with two tissues, two bones, weights, pose, motion, looks and a result.
Document small_document();
// The document with one part changed: labels, names, bones, a stroke of weights, a pose, looks, results added or
// removed.
Document random_edit(const Document& document, std::mt19937& random);
// Weights of 1 MB whose every influence comes from the seed, over a volume that fits.
Document large_document(std::uint32_t seed);

// The same contents, bit for bit.
bool same_contents(const Document& a, const Document& b);

}  // namespace limber::test
