// SPDX-License-Identifier: AGPL-3.0-or-later
// How a program that works on whole bodies takes its memory. Most of it are a few blocks of many megabytes, one value a
// voxel. The usual allocator keeps freed ones for later, and blocks of other sizes then find no room among them: half
// as much again as is in use. And the system hands memory out in pages of 4 KB, which costs more time than filling
// them.
#pragma once

namespace limber {

// From here on, blocks of 8 MB and more go back to the system when they are freed, and come in large pages where the
// system has them. Only a program calls this, once, at its start: it replaces the global operator new.
void use_large_blocks();

// Hands memory that was freed, and that the allocator keeps for later, back to the system.
void return_free_memory();

}  // namespace limber
