// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/export/hdf5_file.h"

#include "core/base/error.h"
#include "core/export/hdf5_codec.h"
#include "core/platform/module.h"

namespace limber {

namespace {
template <class Value>
constexpr int kTypeOf = -1;
template <>
constexpr int kTypeOf<std::uint8_t> = kLimberHdf5UInt8;
template <>
constexpr int kTypeOf<std::int16_t> = kLimberHdf5Int16;
template <>
constexpr int kTypeOf<std::int32_t> = kLimberHdf5Int32;
template <>
constexpr int kTypeOf<float> = kLimberHdf5Float;
template <>
constexpr int kTypeOf<double> = kLimberHdf5Double;
template <>
constexpr int kTypeOf<char> = kLimberHdf5Text;

// Loads the shared library that contains HDF5 (hdf5_codec.h), if it is not loaded yet, and returns its function
// limber_hdf5_make().
//   path  the file to write, for the error message
decltype(&limber_hdf5_make) codec(const Path& path) {
  static const auto loaded = [] {
    void* module = open_module("limber_hdf5");
    return module ? reinterpret_cast<decltype(&limber_hdf5_make)>(symbol_of(module, "limber_hdf5_make")) : nullptr;
  }();
  if (!loaded)
    throw Error("HDF5 cannot be written, because limber_hdf5.so is missing or damaged", path.string(),
                "install Limber again, or choose another format");
  return loaded;
}
}  // namespace

template <class Value>
void Hdf5File::add(const std::string& object, const std::string& attribute, const Value* values, std::size_t count,
                   const std::vector<std::int64_t>& size) {
  const char* bytes = reinterpret_cast<const char*>(values);
  items_.push_back({object, attribute, kTypeOf<Value>, size, std::vector<char>(bytes, bytes + count * sizeof(Value))});
}

void Hdf5File::data(const std::string& name, const std::vector<std::uint8_t>& values,
                    const std::vector<std::int64_t>& size) {
  add(name, "", values.data(), values.size(), size);
}
void Hdf5File::data(const std::string& name, const std::vector<std::int16_t>& values,
                    const std::vector<std::int64_t>& size) {
  add(name, "", values.data(), values.size(), size);
}
void Hdf5File::data(const std::string& name, const std::vector<float>& values, const std::vector<std::int64_t>& size) {
  add(name, "", values.data(), values.size(), size);
}
void Hdf5File::attribute(const std::string& object, const std::string& name, double value) {
  add(object, name, &value, 1, {});
}
void Hdf5File::attribute(const std::string& object, const std::string& name, std::int32_t value) {
  add(object, name, &value, 1, {});
}
void Hdf5File::attribute(const std::string& object, const std::string& name, const std::string& text) {
  add(object, name, text.data(), text.size(), {});
}
void Hdf5File::attribute(const std::string& object, const std::string& name, const std::vector<float>& values) {
  add(object, name, values.data(), values.size(), {std::ssize(values)});
}
void Hdf5File::attribute(const std::string& object, const std::string& name, const std::vector<double>& values) {
  add(object, name, values.data(), values.size(), {std::ssize(values)});
}

void Hdf5File::write(const Path& path) const {
  const auto make = codec(path);
  std::vector<LimberHdf5Item> items;
  for (const Item& item : items_) {
    LimberHdf5Item& plain = items.emplace_back(LimberHdf5Item{item.object.c_str(),
                                                              item.attribute.empty() ? nullptr : item.attribute.c_str(),
                                                              item.type,
                                                              static_cast<int>(item.size.size()),
                                                              {},
                                                              item.bytes.data(),
                                                              item.bytes.size()});
    std::copy(item.size.begin(), item.size.end(), plain.size);
  }
  std::string file;
  const auto take = [](void* context, const void* bytes, std::size_t size) {
    static_cast<std::string*>(context)->assign(static_cast<const char*>(bytes), size);
  };
  if (make(items.data(), items.size(), take, &file) != 0)
    throw Error("the file cannot be made", path.string(), "free some memory, or choose another format");
  write_file_atomically(path, file);
}

}  // namespace limber
