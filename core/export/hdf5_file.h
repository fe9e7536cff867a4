// SPDX-License-Identifier: AGPL-3.0-or-later
// Builds and writes an HDF5 file of data sets and attributes. Data sets have up to three dimensions, in the order of C
// arrays (the last index varies fastest). Data sets with three dimensions are compressed. The HDF5 library is loaded
// when the first file is written (hdf5_codec.h).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/file.h"

namespace limber {

class Hdf5File {
 public:
  void data(const std::string& name, const std::vector<std::uint8_t>& values, const std::vector<std::int64_t>& size);
  void data(const std::string& name, const std::vector<std::int16_t>& values, const std::vector<std::int64_t>& size);
  void data(const std::string& name, const std::vector<float>& values, const std::vector<std::int64_t>& size);

  // Adds an attribute to an object: "/" (the whole file) or the name of a data set that has been added before.
  void attribute(const std::string& object, const std::string& name, double value);
  void attribute(const std::string& object, const std::string& name, std::int32_t value);
  void attribute(const std::string& object, const std::string& name, const std::string& text);
  void attribute(const std::string& object, const std::string& name, const std::vector<float>& values);
  void attribute(const std::string& object, const std::string& name, const std::vector<double>& values);

  // Writes the file. Throws Error when the HDF5 library is missing or the file cannot be written.
  void write(const Path& path) const;

 private:
  struct Item {
    std::string object, attribute;  // name of the object and of its attribute; attribute empty: a data set
    int type;
    std::vector<std::int64_t> size;
    std::vector<char> bytes;
  };
  template <class Value>
  void add(const std::string& object, const std::string& attribute, const Value* values, std::size_t count,
           const std::vector<std::int64_t>& size);
  std::vector<Item> items_;
};

}  // namespace limber
