// SPDX-License-Identifier: AGPL-3.0-or-later
// The writing half of volume_io.h. Every byte goes once through one chunk: labels are looked up, deflated and written.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <optional>
#include <span>

#include <fcntl.h>
#include <unistd.h>

#include "core/base/deflate.h"
#include "core/base/error.h"
#include "core/volume/header_text.h"
#include "core/volume/nifti_header.h"
#include "core/volume/nrrd_header.h"
#include "core/volume/vector_volume_io.h"
#include "core/volume/virtual_family.h"
#include "core/volume/volume_header.h"
#include "core/volume/volume_files.h"
#include "core/volume/volume_io.h"

namespace limber {

namespace {
static_assert(std::endian::native == std::endian::little, "files are written in native byte order and say little endian");

constexpr std::size_t kChunkVoxels = 1 << 14;
// A file being written, plainly or deflated.
class OutputFile {
 public:
  explicit OutputFile(const Path& path) : path_(path) {
    descriptor_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (descriptor_ < 0) fail();
  }
  ~OutputFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void begin_deflate(Deflater::Wrap wrap) {
    deflater_.emplace(wrap, [this](const void* bytes, std::size_t size) { put(bytes, size); });
  }
  void write(const void* bytes, std::size_t size) { deflater_ ? deflater_->write(bytes, size) : put(bytes, size); }
  void end_deflate() {
    deflater_->end();
    deflater_.reset();
  }
  std::int64_t place() const { return place_; }
  void overwrite(std::int64_t place, const std::string& text) {
    if (::pwrite(descriptor_, text.data(), text.size(), place) != static_cast<ssize_t>(text.size())) fail();
  }
  void close() {
    const int descriptor = descriptor_;
    descriptor_ = -1;
    if (::close(descriptor) != 0) fail();
  }

 private:
  void put(const void* bytes, std::size_t size) {
    const char* from = static_cast<const char*>(bytes);
    while (size > 0) {
      const ssize_t done = ::write(descriptor_, from, size);
      if (done < 0 && errno == EINTR) continue;
      if (done <= 0) fail();
      from += done;
      size -= static_cast<std::size_t>(done);
      place_ += done;
    }
  }
  [[noreturn]] void fail() const { throw Error("the file cannot be written", path_.string(), std::strerror(errno)); }

  Path path_;
  int descriptor_ = -1;
  std::int64_t place_ = 0;
  std::optional<Deflater> deflater_;  // while bytes are packed
};

// What is to be written, whatever the format.
struct Voxels {
  Grid grid;
  VoxelType type = VoxelType::UInt8;
  int channels = 1;
  bool compress = true;
  // Fills `to` with `count` voxels from `first` on.
  std::function<void(std::int64_t first, std::size_t count, void* to)> fill;
  TissueTable tissues;             // for formats that hold names
  int nifti_version = 1;
  std::string description = {};  // one line of ASCII, at most 79 letters, which is what NIfTI has room for
  std::vector<std::pair<std::string, std::string>> keys = {};  // of NRRD
};

void write_voxels(OutputFile& out, const Voxels& voxels) {
  const std::size_t size = static_cast<std::size_t>(size_of(voxels.type) * voxels.channels);
  std::vector<std::uint64_t> chunk(kChunkVoxels * size / sizeof(std::uint64_t) + 1);
  const std::int64_t total = voxels.grid.voxel_count();
  for (std::int64_t first = 0; first < total; first += kChunkVoxels) {
    const auto count = static_cast<std::size_t>(std::min<std::int64_t>(kChunkVoxels, total - first));
    voxels.fill(first, count, chunk.data());
    out.write(chunk.data(), count * size);
  }
}

std::string joined(const glm::dvec3& v, const char* between = " ") { return text_of(v.x) + between + text_of(v.y) + between + text_of(v.z); }
std::string sizes_text(const Grid& grid) {
  return std::to_string(grid.size.x) + " " + std::to_string(grid.size.y) + " " + std::to_string(grid.size.z);
}

void write_text(OutputFile& out, const std::string& text) { out.write(text.data(), text.size()); }

void write_data(OutputFile& out, const Voxels& voxels, Deflater::Wrap wrap) {
  if (voxels.compress) out.begin_deflate(wrap);
  write_voxels(out, voxels);
  if (voxels.compress) out.end_deflate();
}

// ---- NRRD

std::string_view nrrd_type_name(VoxelType type) {
  if (type == VoxelType::Float32) return "float";
  if (type == VoxelType::Float64) return "double";
  return to_string(type);
}

std::vector<std::pair<std::string, std::string>> segment_keys(const TissueTable& tissues, const Grid& grid) {
  const bool named = std::any_of(tissues.tissues.begin(), tissues.tissues.end(), [](const Tissue& t) { return !t.name.empty(); });
  if (!named) return {};
  std::vector<std::pair<std::string, std::string>> keys;
  int number = 0;
  for (const Tissue& tissue : tissues.tissues) {
    const std::string prefix = "Segment" + std::to_string(number++) + "_", value = text_of(tissue.file_value);
    keys.emplace_back(prefix + "ID", "Segment_" + value);
    keys.emplace_back(prefix + "Name", tissue.name.empty() ? "label " + value : tissue.name);
    keys.emplace_back(prefix + "Color", text_of(tissue.colour.r) + " " + text_of(tissue.colour.g) + " " + text_of(tissue.colour.b));
    keys.emplace_back(prefix + "LabelValue", value);
    keys.emplace_back(prefix + "Layer", "0");
    keys.emplace_back(prefix + "Extent", "0 " + std::to_string(grid.size.x - 1) + " 0 " + std::to_string(grid.size.y - 1) + " 0 " + std::to_string(grid.size.z - 1));
  }
  keys.emplace_back("Segmentation_SourceRepresentation", "Binary labelmap");
  keys.emplace_back("Segmentation_ContainedRepresentationNames", "Binary labelmap|");
  keys.emplace_back("Segmentation_ReferenceImageExtentOffset", "0 0 0");
  return keys;
}
std::string nrrd_header(const Voxels& voxels, const std::string& data_name) {
  const Grid& grid = voxels.grid;
  const AffineTransform world = world_from_voxel(grid);
  const bool many = voxels.channels > 1;
  std::string text = "NRRD0005\ntype: " + std::string(nrrd_type_name(voxels.type)) + "\ndimension: " + (many ? "4" : "3") +
                     "\nspace: left-posterior-superior\nsizes: " + (many ? std::to_string(voxels.channels) + " " : "") + sizes_text(grid) +
                     "\nspace directions: " + (many ? "none " : "");
  for (int axis = 0; axis < 3; ++axis) text += "(" + joined(world.linear[axis], ",") + (axis < 2 ? ") " : ")\n");
  text += std::string("kinds: ") + (many ? "vector " : "") + "domain domain domain\n";
  if (size_of(voxels.type) > 1) text += "endian: little\n";
  text += std::string("encoding: ") + (voxels.compress ? "gzip" : "raw") + "\nspace origin: (" + joined(grid.origin, ",") + ")\n";
  if (!data_name.empty()) text += "data file: " + data_name + "\n";
  if (!voxels.description.empty()) text += "content: " + voxels.description + "\n";
  for (const auto& [key, value] : voxels.keys) text += key + ":=" + nrrd_escaped(value) + "\n";
  for (const auto& [key, value] : segment_keys(voxels.tissues, grid)) text += key + ":=" + nrrd_escaped(value) + "\n";
  return text + "\n";
}

void write_nrrd(const Voxels& voxels, const Path& path) {
  write_atomically(path, [&](const Path& temporary) {
    OutputFile out(temporary);
    write_text(out, nrrd_header(voxels, ""));
    write_data(out, voxels, Deflater::Wrap::Gzip);
    out.close();
  });
}

// Data first, so that a header never names data that are not there.
void write_detached(const Voxels& voxels, const Path& header_path, const std::string& data_extension, Deflater::Wrap wrap,
                    const std::function<std::string(const std::string& data_name, std::int64_t bytes)>& header) {
  const Path data_path = Path(header_path).replace_extension(data_extension);
  std::int64_t bytes = 0;
  write_atomically(data_path, [&](const Path& temporary) {
    OutputFile out(temporary);
    write_data(out, voxels, wrap);
    bytes = out.place();
    out.close();
  });
  write_file_atomically(header_path, header(data_path.filename().string(), bytes));
}

// ---- MetaImage

std::string_view meta_type_name(VoxelType type) {
  constexpr std::array<std::string_view, 10> kNames = {"MET_CHAR", "MET_UCHAR", "MET_SHORT",     "MET_USHORT",     "MET_INT",
                                                       "MET_UINT", "MET_LONG_LONG", "MET_ULONG_LONG", "MET_FLOAT", "MET_DOUBLE"};
  return kNames[static_cast<std::size_t>(type)];
}

constexpr std::string_view kCompressedSize = "CompressedDataSize = ";

std::string meta_header(const Voxels& voxels, const std::string& data_name, const std::string& compressed_size) {
  const Grid& grid = voxels.grid;
  std::string text = "ObjectType = Image\nNDims = 3\n";
  if (!voxels.description.empty()) text += "Comment = " + voxels.description + "\n";
  text += "BinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = " +
          std::string(voxels.compress ? "True" : "False") + "\n";
  if (voxels.compress) text += std::string(kCompressedSize) + compressed_size + "\n";
  text += "TransformMatrix =";
  for (int axis = 0; axis < 3; ++axis) text += " " + joined(grid.direction[axis]);
  text += "\nOffset = " + joined(grid.origin) + "\nCenterOfRotation = 0 0 0\nElementSpacing = " + joined(grid.spacing) +
          "\nDimSize = " + sizes_text(grid) + "\n";
  if (voxels.channels > 1) text += "ElementNumberOfChannels = " + std::to_string(voxels.channels) + "\n";
  return text + "ElementType = " + std::string(meta_type_name(voxels.type)) + "\nElementDataFile = " + data_name + "\n";
}

void write_meta(const Voxels& voxels, const Path& path) {
  constexpr int kDigits = 15;  // the size is known only afterwards; blanks keep its place
  write_atomically(path, [&](const Path& temporary) {
    OutputFile out(temporary);
    const std::string header = meta_header(voxels, "LOCAL", std::string(kDigits, ' '));
    write_text(out, header);
    write_data(out, voxels, Deflater::Wrap::Zlib);
    if (voxels.compress)
      out.overwrite(static_cast<std::int64_t>(header.find(kCompressedSize) + kCompressedSize.size()),
                    std::to_string(out.place() - static_cast<std::int64_t>(header.size())));
    out.close();
  });
}

// ---- NIfTI

// Version 1 counts voxels in 16 bits.
int nifti_version(const Voxels& voxels) {
  const glm::ivec3 size = voxels.grid.size;
  return std::max({size.x, size.y, size.z}) > 32767 ? 2 : voxels.nifti_version;
}

std::string nifti_header(const Voxels& voxels, bool is_pair) {
  const int version = nifti_version(voxels);
  std::string bytes = make_nifti_header(voxels.grid, voxels.type, voxels.channels, version, is_pair);
  constexpr std::size_t kDescription[] = {148, 240};  // `descrip` of versions 1 and 2
  bytes.replace(kDescription[version - 1], voxels.description.size(), voxels.description);
  return bytes;
}

void write_nifti(const Voxels& voxels, const Path& path) {
  const bool compress = lower_case(path.extension().string()) == ".gz";
  write_atomically(path, [&](const Path& temporary) {
    OutputFile out(temporary);
    if (compress) out.begin_deflate(Deflater::Wrap::Gzip);
    write_text(out, nifti_header(voxels, false));
    write_voxels(out, voxels);
    if (compress) out.end_deflate();
    out.close();
  });
}

// ---- Which format

using Writer = void (*)(const Voxels&, const Path&);

Writer writer_of(const Path& path) {
  const std::string name = lower_case(path.filename().string());
  const auto ends = [&](const char* end) { return name.ends_with(end) && name.size() > std::strlen(end); };
  if (ends(".nrrd")) return write_nrrd;
  if (ends(".nhdr"))
    return [](const Voxels& voxels, const Path& to) {
      write_detached(voxels, to, voxels.compress ? ".raw.gz" : ".raw", Deflater::Wrap::Gzip,
                     [&](const std::string& data, std::int64_t) { return nrrd_header(voxels, data); });
    };
  if (ends(".mha")) return write_meta;
  if (ends(".mhd"))
    return [](const Voxels& voxels, const Path& to) {
      write_detached(voxels, to, voxels.compress ? ".zraw" : ".raw", Deflater::Wrap::Zlib,
                     [&](const std::string& data, std::int64_t bytes) { return meta_header(voxels, data, std::to_string(bytes)); });
    };
  if (ends(".nii") || ends(".nii.gz")) return write_nifti;
  if (ends(".hdr"))
    return [](const Voxels& voxels, const Path& to) {
      Voxels plain = voxels;
      plain.compress = false;
      write_detached(plain, to, ".img", Deflater::Wrap::Gzip, [&](const std::string&, std::int64_t) {
        return nifti_header(plain, true);
      });
    };
  if (ends(".txt"))
    return [](const Voxels& voxels, const Path& to) {
      if (voxels.type != VoxelType::UInt8 && voxels.type != VoxelType::UInt16)
        throw Error("Virtual Family files hold labels of 8 or 16 bits", to.string(), "write .nrrd, .mha or .nii.gz");
      Voxels plain = voxels;
      plain.compress = false;
      write_detached(plain, to, ".raw", Deflater::Wrap::Gzip, [&](const std::string&, std::int64_t) { return make_virtual_family(voxels.grid, voxels.tissues); });
    };
  return nullptr;
}

std::string format_of(const Path& path) {
  const std::string name = lower_case(path.filename().string());
  if (name.ends_with(".nrrd") || name.ends_with(".nhdr")) return "NRRD";
  if (name.ends_with(".mha") || name.ends_with(".mhd")) return "MetaImage";
  if (name.ends_with(".txt")) return "Virtual Family";
  return "";
}

Writer checked_writer(const Path& path) {
  const Writer writer = writer_of(path);
  if (!writer) throw Error("volumes cannot be written under this name", path.string(), "end it in .nrrd, .seg.nrrd, .nhdr, .mha, .mhd, .nii, .nii.gz, .hdr or .txt (Virtual Family)");
  return writer;
}

// The narrowest type of `wanted`'s family (signed, unsigned, real) that holds all values; another family when it must.
VoxelType type_that_holds(double lowest, double highest, std::optional<VoxelType> wanted) {
  using enum VoxelType;
  const auto holds = [&](VoxelType type) {
    return visit_voxel_type(type, [&]<class T>(T) {
      if constexpr (std::is_floating_point_v<T>) {
        const double exact = std::ldexp(1.0, std::numeric_limits<T>::digits);
        return -exact <= lowest && highest <= exact;
      } else {
        return static_cast<double>(std::numeric_limits<T>::lowest()) <= lowest && highest <= static_cast<double>(std::numeric_limits<T>::max());
      }
    });
  };
  if (wanted && holds(*wanted)) return *wanted;
  const bool real = wanted && (*wanted == Float32 || *wanted == Float64);
  if (real) return Float64;
  const bool is_signed = lowest < 0 || (wanted && (*wanted == Int8 || *wanted == Int16 || *wanted == Int32 || *wanted == Int64));
  const std::array<VoxelType, 4> family = is_signed ? std::array{Int8, Int16, Int32, Int64} : std::array{UInt8, UInt16, UInt32, UInt64};
  for (VoxelType type : family)
    if (holds(type) && (!wanted || size_of(type) >= size_of(*wanted))) return type;
  return is_signed ? Int64 : UInt64;
}

}  // namespace

void check_writable(const Path& path) {
  checked_writer(path);
  check_place(path);
}

std::vector<Path> files_written_as(const Path& path) {
  const std::string ending = lower_case(path.extension().string());
  std::vector<Path> files{path};
  const auto beside = [&](const char* data) { files.push_back(Path(path).replace_extension(data)); };
  if (ending == ".nhdr") beside(".raw"), beside(".raw.gz");
  if (ending == ".mhd") beside(".raw"), beside(".zraw");
  if (ending == ".hdr") beside(".img");
  if (ending == ".txt") beside(".raw");
  return files;
}

void write_volume(const LabelVolume& volume, const Path& path, const TissueTable& tissues, const FileType& type) {
  const Writer writer = checked_writer(path);
  std::vector<std::uint8_t> present(65536);
  for (Label label : volume.voxels) present[label] = 1;
  std::vector<double> value_of(65536);
  for (std::size_t label = 0; label < value_of.size(); ++label) value_of[label] = static_cast<double>(label);
  for (const Tissue& tissue : tissues.tissues) value_of[tissue.label] = tissue.label == 0 ? 0 : tissue.file_value;
  double lowest = 0, highest = 0;
  for (std::size_t label = 0; label < value_of.size(); ++label)
    if (present[label]) {
      lowest = std::min(lowest, value_of[label]);
      highest = std::max(highest, value_of[label]);
    }

  Voxels voxels{volume.grid, type_that_holds(lowest, highest, voxel_type_from_text(type.voxel_type)), 1,
                type.compressed || type.format != format_of(path), {}, tissues, type.format == "NIfTI-2" ? 2 : 1};
  visit_voxel_type(voxels.type, [&]<class T>(T) {
    std::vector<T> stored(65536);
    for (std::size_t label = 0; label < stored.size(); ++label)
      if (present[label]) stored[label] = static_cast<T>(value_of[label]);
    voxels.fill = [&volume, stored = std::move(stored)](std::int64_t first, std::size_t count, void* to) {
      const Label* from = &volume.voxels[static_cast<std::size_t>(first)];
      T* out = static_cast<T*>(to);
      for (std::size_t i = 0; i < count; ++i) out[i] = stored[from[i]];
    };
  });
  writer(voxels, path);
}

void write_grey_volume(const GreyVolume& volume, const Path& path) {
  const Writer writer = checked_writer(path);
  // Whole values stay in the type they came in; what was interpolated becomes float.
  const auto wanted = voxel_type_from_text(volume.type.voxel_type).value_or(VoxelType::Float32);
  const bool keeps = visit_voxel_type(wanted, [&]<class T>(T) {
    if constexpr (std::is_floating_point_v<T>) return true;
    else
      return std::all_of(volume.voxels.begin(), volume.voxels.end(), [](float v) {
        return v == std::floor(v) && static_cast<double>(v) >= static_cast<double>(std::numeric_limits<T>::lowest()) &&
               static_cast<double>(v) < static_cast<double>(std::numeric_limits<T>::max()) + 1;
      });
  });
  Voxels voxels{volume.grid, keeps ? wanted : VoxelType::Float32, 1, volume.type.compressed || volume.type.format != format_of(path), {}, {}, volume.type.format == "NIfTI-2" ? 2 : 1};
  visit_voxel_type(voxels.type, [&]<class T>(T) {
    voxels.fill = [&volume](std::int64_t first, std::size_t count, void* to) {
      T* out = static_cast<T*>(to);
      for (std::size_t i = 0; i < count; ++i) out[i] = static_cast<T>(volume.voxels[static_cast<std::size_t>(first) + i]);
    };
  });
  writer(voxels, path);
}

void write_vector_volume(const Grid& grid, std::span<const glm::vec3> vectors, const Path& path) {
  Voxels voxels{grid, VoxelType::Float32, 3, true, {}, {}, 1};
  voxels.fill = [&vectors](std::int64_t first, std::size_t count, void* to) {
    std::memcpy(to, &vectors[static_cast<std::size_t>(first)], count * sizeof(glm::vec3));
  };
  checked_writer(path)(voxels, path);
}

void write_displacement_field(const Grid& grid, std::span<const glm::vec3> to_posed, FieldDirection direction, const Path& path) {
  const bool to_rest = direction == FieldDirection::ToRest;
  Voxels voxels{grid, VoxelType::Float32, 3, true, {}, {}, 1};
  voxels.description = to_rest ? "displacement, mm, LPS: rest minus posed, at posed voxels (as ITK warps rest)" : "displacement, mm, LPS: posed minus rest, at posed voxels";
  voxels.keys = {{kFieldDirectionKey, to_rest ? kToRest : kToPosed}};
  voxels.fill = [&to_posed, to_rest](std::int64_t first, std::size_t count, void* to) {
    auto* out = static_cast<glm::vec3*>(to);
    for (std::size_t i = 0; i < count; ++i) out[i] = to_rest ? glm::vec3(0) - to_posed[static_cast<std::size_t>(first) + i] : to_posed[static_cast<std::size_t>(first) + i];
  };
  checked_writer(path)(voxels, path);
}

void write_scalar_volume(const Grid& grid, std::span<const float> values, const Path& path) {
  Voxels voxels{grid, VoxelType::Float32, 1, true, {}, {}, 1};
  voxels.fill = [&values](std::int64_t first, std::size_t count, void* to) {
    std::memcpy(to, &values[static_cast<std::size_t>(first)], count * sizeof(float));
  };
  checked_writer(path)(voxels, path);
}

}  // namespace limber
