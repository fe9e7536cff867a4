// SPDX-License-Identifier: AGPL-3.0-or-later
// Small documents that have every part of a document, random edits like those of operators, and a comparison of
// contents.
#pragma once

#include <cstdint>
#include <random>

#include "core/project/document.h"

namespace limber::test {

// Returns a bar of 24 x 10 x 9 voxels with two tissues, two bones, weights, pose, motion, looks and a result.
Document small_document();
// Returns the document after a random edit of one part: labels, names, bones, a brush stroke on the weights, a pose,
// looks, or a result added or removed.
Document random_edit(const Document& document, std::mt19937& random);
// Returns a document with 1 MB of random weights, generated from `seed`, and with the volume that they belong to.
Document large_document(std::uint32_t seed);

// Returns true if the documents have the same contents, bit for bit.
bool same_contents(const Document& a, const Document& b);

}  // namespace limber::test
