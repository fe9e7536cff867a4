// SPDX-License-Identifier: AGPL-3.0-or-later
// The interface through which hdf5_file.cpp uses the HDF5 library, as one C function in a shared library of its own.
// HDF5 loads forty other libraries (it can read from the web), which takes 9 ms. So it is loaded only when an HDF5 file
// is written, and not at every start.
#pragma once

#include <cstddef>
#include <cstdint>

extern "C" {
struct LimberHdf5Item {
  const char* object;
  const char* attribute;  // null: the item is a data set
  int type;               // kLimberHdf5UInt8 ... kLimberHdf5Text
  int rank;               // number of dimensions; 0: a single value
  std::int64_t size[3];
  const void* values;
  std::size_t bytes;
};
enum { kLimberHdf5UInt8, kLimberHdf5Int16, kLimberHdf5Int32, kLimberHdf5Float, kLimberHdf5Double, kLimberHdf5Text };

// Builds an HDF5 file of the items in memory and passes its bytes to `take`. Returns 0, or 1 on failure.
int limber_hdf5_make(const LimberHdf5Item* items, std::size_t count,
                     void (*take)(void* context, const void* bytes, std::size_t size), void* context);
}
