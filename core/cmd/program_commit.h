// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

namespace limber::cmd {

// The commit that the program was built from, with its date: "727d71c of 2026-11-27". The text also says if sources
// were changed since that commit. It is "" if the sources are in no repository. The build writes it
// (program_commit.cmake).
extern const char* const kProgramCommit;

}  // namespace limber::cmd
