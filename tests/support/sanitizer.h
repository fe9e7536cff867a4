// SPDX-License-Identifier: AGPL-3.0-or-later
// LIMBER_ADDRESS_SANITIZER: the process takes terabytes of address space, and memory limits mean nothing.
#pragma once

#ifdef __SANITIZE_ADDRESS__
#define LIMBER_ADDRESS_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define LIMBER_ADDRESS_SANITIZER 1
#endif
#endif
