// SPDX-License-Identifier: AGPL-3.0-or-later
// Identifies the program that computed a cell of a study, since the cell's result depends on the program besides the
// inputs. A version number would miss changes while the program is being developed. A hash of the whole program would
// change too often: every change of the report page would discard hours of solves.
#pragma once

namespace limber {

// Returns the SHA-256 of the sources that compute a cell, from reading a volume to the figures of its report (core/base
// to core/report). The build makes this hash (hash_sources.cmake).
const char* computing_sources();

}  // namespace limber
