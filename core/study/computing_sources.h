// SPDX-License-Identifier: AGPL-3.0-or-later
// What a cell's result depends on beside its inputs: the program. A version says too little while a program is worked
// on, and a hash of the program too much: every change of a page would throw hours of solves away.
#pragma once

namespace limber {

// SHA-256 of the sources that compute a cell, from reading a volume to its figures: core/base to core/report. Made by
// the build.
const char* computing_sources();

}  // namespace limber
