// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

// Inlines a function wherever it is called, so that it is compiled for the same processor type as its caller.
#define LIMBER_INLINE [[gnu::always_inline]] inline
