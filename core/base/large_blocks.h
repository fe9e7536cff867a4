// SPDX-License-Identifier: AGPL-3.0-or-later
// Sets how a program that works on whole bodies allocates memory. Most of that memory is a few blocks of many megabytes
// with one value per voxel. The default allocator keeps freed blocks. Blocks of other sizes do not fit into them, so
// the allocator holds half as much memory again as is in use. It also takes memory in pages of 4 KB, whose page faults
// take more time than filling the pages.
#pragma once

namespace limber {

// From this call on, blocks of 8 MB and more return to the system when they are freed, and use large pages where the
// system has them. Only a program's main calls this, once, and never a library, because this file also replaces the
// global operator new.
void use_large_blocks();

// Gives freed memory that the allocator still holds back to the system.
void return_free_memory();

}  // namespace limber
