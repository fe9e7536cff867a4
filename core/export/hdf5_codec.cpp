// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/export/hdf5_codec.h"

#include <algorithm>
#include <exception>
#include <vector>

#include <hdf5.h>

namespace {

// Owns a handle of the HDF5 library and closes it.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }
  bool ok() const { return id_ >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

hid_t type_of(const LimberHdf5Item& item) {
  switch (item.type) {
    case kLimberHdf5UInt8: return H5Tcopy(H5T_NATIVE_UINT8);
    case kLimberHdf5Int16: return H5Tcopy(H5T_NATIVE_INT16);
    case kLimberHdf5Int32: return H5Tcopy(H5T_NATIVE_INT32);
    case kLimberHdf5Float: return H5Tcopy(H5T_NATIVE_FLOAT);
    case kLimberHdf5Double: return H5Tcopy(H5T_NATIVE_DOUBLE);
    default: {
      const hid_t text = H5Tcopy(H5T_C_S1);
      H5Tset_size(text, std::max<std::size_t>(item.bytes, 1));
      return text;
    }
  }
}

bool write_item(hid_t file, const LimberHdf5Item& item) {
  hsize_t size[3] = {1, 1, 1};
  for (int i = 0; i < item.rank; ++i) size[i] = static_cast<hsize_t>(item.size[i]);
  const Handle type(type_of(item), H5Tclose);
  const Handle space(item.rank == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(item.rank, size, nullptr), H5Sclose);
  if (item.attribute) {
    const Handle object(H5Oopen(file, item.object, H5P_DEFAULT), H5Oclose);
    if (!object.ok()) return false;
    const Handle attribute(H5Acreate2(object, item.attribute, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    return attribute.ok() && H5Awrite(attribute, type, item.values) >= 0;
  }
  const Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose), layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(links, 1);
  H5Pset_obj_track_times(layout, 0);  // stores no times, so that equal data give equal files
  if (item.rank == 3) {
    const hsize_t chunk[3] = {1, size[1], size[2]};
    H5Pset_chunk(layout, 3, chunk);
    H5Pset_deflate(layout, 4);
  }
  const Handle data(H5Dcreate2(file, item.object, type, space, links, layout, H5P_DEFAULT), H5Dclose);
  return data.ok() && H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, item.values) >= 0;
}

}  // namespace

int limber_hdf5_make(const LimberHdf5Item* items, std::size_t count,
                     void (*take)(void* context, const void* bytes, std::size_t size), void* context) try {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  constexpr std::size_t kGrowth = 1 << 20;
  if (H5Pset_fapl_core(access, kGrowth, 0) < 0) return 1;
  const Handle file(H5Fcreate("limber.h5", H5F_ACC_TRUNC, H5P_DEFAULT, access), H5Fclose);
  if (!file.ok()) return 1;
  for (std::size_t i = 0; i < count; ++i)
    if (!write_item(file, items[i])) return 1;
  if (H5Fflush(file, H5F_SCOPE_GLOBAL) < 0) return 1;
  std::vector<char> bytes(static_cast<std::size_t>(std::max<std::ptrdiff_t>(H5Fget_file_image(file, nullptr, 0), 0)));
  if (bytes.empty() || H5Fget_file_image(file, bytes.data(), bytes.size()) < 0) return 1;
  take(context, bytes.data(), bytes.size());
  return 0;
} catch (const std::exception&) {
  return 1;
}
