// SPDX-License-Identifier: AGPL-3.0-or-later
// Identifies the version of the program that computed a cell of a study, since results depend on the program as well as
// on the inputs. A version number would miss changes while the program is being developed. A hash of the whole program
// would change too often: every change of the report page would discard hours of solves.
#pragma once

namespace limber {

// Returns the SHA-256 of the source files that compute a cell (one spacing, pose and technique), from reading a volume
// to the figures of its report (core/platform to core/report). The build computes this hash (hash_sources.cmake).
const char* computing_sources();

}  // namespace limber
