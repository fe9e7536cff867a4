// SPDX-License-Identifier: AGPL-3.0-or-later
// Defines LIMBER_ADDRESS_SANITIZER in builds with AddressSanitizer. Such a process reserves terabytes of address space,
// so tests of memory limits make no sense in it.
#pragma once

#ifdef __SANITIZE_ADDRESS__
#define LIMBER_ADDRESS_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define LIMBER_ADDRESS_SANITIZER 1
#endif
#endif
