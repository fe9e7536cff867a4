// SPDX-License-Identifier: AGPL-3.0-or-later
// For builds with sanitizers: turns off the leak check in a program that parses files in a sandbox. The check starts a
// process that stops this one, which the sandbox forbids. Other errors end the program by the signal of a crash, as the
// tests of crashes expect, instead of by a report.
#include "tests/support/sanitizer.h"

#ifdef LIMBER_ADDRESS_SANITIZER
extern "C" const char* __asan_default_options() {
  return "detect_leaks=0:handle_segv=0:handle_sigbus=0:handle_abort=0";
}
#endif
