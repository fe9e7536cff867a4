// SPDX-License-Identifier: AGPL-3.0-or-later
// For builds with sanitizers: a program that parses files without rights may not do what the search for leaks needs (it
// starts a process that stops this one), so it does without. It ends by the signal of a crash, as the tests of crashes
// expect, instead of by a report. All other checks stay.
#include "tests/support/sanitizer.h"

#ifdef LIMBER_ADDRESS_SANITIZER
extern "C" const char* __asan_default_options() {
  return "detect_leaks=0:handle_segv=0:handle_sigbus=0:handle_abort=0";
}
#endif
