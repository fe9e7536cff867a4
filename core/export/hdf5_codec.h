// SPDX-License-Identifier: AGPL-3.0-or-later
// The C function through which hdf5_file.cpp uses the HDF5 library. The function is in a shared library of its own,
// which is loaded only when an HDF5 file is written: HDF5 needs forty other libraries (it can read from the web), and
// loading them at every start of the program would take 9 ms.
#pragma once

#include <cstddef>
#include <cstdint>

extern "C" {
struct LimberHdf5Item {
  const char* object;
  const char* attribute;  // name of the attribute; null: the item is a data set
  int type;               // type of the values: kLimberHdf5UInt8 ... kLimberHdf5Text
  int rank;               // number of dimensions; 0: a single value
  std::int64_t size[3];
  const void* values;
  std::size_t bytes;
};
enum { kLimberHdf5UInt8, kLimberHdf5Int16, kLimberHdf5Int32, kLimberHdf5Float, kLimberHdf5Double, kLimberHdf5Text };

// Builds an HDF5 file from the items, in memory, and passes the file's bytes to take(). Returns 0; on failure 1.
int limber_hdf5_make(const LimberHdf5Item* items, std::size_t count,
                     void (*take)(void* context, const void* bytes, std::size_t size), void* context);
}
