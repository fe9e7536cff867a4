// SPDX-License-Identifier: AGPL-3.0-or-later
// Sets how a program that works on whole bodies allocates memory. Most of that memory is a few blocks of many megabytes
// with one value per voxel. The default allocator keeps freed blocks, and blocks of other sizes do not fit into them,
// so that it takes 1.5 times the memory in use. It also uses pages of 4 KB, whose page faults take more time than
// filling the pages.
#pragma once

namespace limber {

// From this call on, memory blocks of 8 MB and more return to the system when they are freed, and use large pages where
// the system has them. A program's main calls this once. A library never calls it, because this file also replaces the
// global operator new.
void use_large_blocks();

// Returns memory to the system that the program has freed but the allocator still keeps.
void return_free_memory();

}  // namespace limber
