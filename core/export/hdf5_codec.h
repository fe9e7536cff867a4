// SPDX-License-Identifier: AGPL-3.0-or-later
// What hdf5_file.cpp needs of HDF5, as one plain function. The library brings forty others with it (it can read from
// the web), which costs 9 ms at every start; as a module of its own it is loaded only when a file is written.
#pragma once

#include <cstddef>
#include <cstdint>

extern "C" {
struct LimberHdf5Item {
  const char* object;
  const char* attribute;  // null: a data set
  int type;               // kLimberHdf5...
  int rank;               // 0: one value
  std::int64_t size[3];
  const void* values;
  std::size_t bytes;
};
enum { kLimberHdf5UInt8, kLimberHdf5Int16, kLimberHdf5Int32, kLimberHdf5Float, kLimberHdf5Double, kLimberHdf5Text };

// Makes the file in memory (the library takes no file without a name) and hands it over. Returns 0, or 1 when it could
// not be made.
int limber_hdf5_make(const LimberHdf5Item* items, std::size_t count,
                     void (*take)(void* context, const void* bytes, std::size_t size), void* context);
}
