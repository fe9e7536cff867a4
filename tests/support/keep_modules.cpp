// SPDX-License-Identifier: AGPL-3.0-or-later
// For builds with sanitizers: keeps shared libraries loaded until the process ends. Memory that a graphics driver leaks
// is then reported with the driver's name, which leaks.supp lists, and not as leaked by an unknown module.
#include "tests/support/sanitizer.h"

#ifdef LIMBER_ADDRESS_SANITIZER
extern "C" int dlclose(void*) { return 0; }
#endif
