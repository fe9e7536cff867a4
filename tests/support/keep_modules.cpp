// SPDX-License-Identifier: AGPL-3.0-or-later
// For builds with sanitizers: modules stay loaded until the process ends, so that what a driver leaks is reported under
// the driver's name (leaks.supp) and not as unknown.
#include "tests/support/sanitizer.h"

#ifdef LIMBER_ADDRESS_SANITIZER
extern "C" int dlclose(void*) { return 0; }
#endif
