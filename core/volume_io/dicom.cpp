// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume_io/dicom.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "core/base/error.h"
#include "core/base/text_parse.h"
#include "core/platform/module.h"
#include "core/volume_io/dicom_codec.h"

namespace limber {

namespace fs = std::filesystem;

namespace {
constexpr std::size_t kMostFiles = 100000;
// A series is refused if a gap between slices differs from the mean gap by more than this share of the mean gap. Slice
// positions are rounded decimal text, so equal gaps differ slightly.
constexpr double kEvenGaps = 0.02;
// Largest number of bytes into which one byte of a compressed slice can unpack. A file too small for its pixels is
// refused.
constexpr std::int64_t kCodecMost = 4000;
// Memory that GDCM may use in addition to the file (which GDCM holds up to four times) and the pixels (which JPEG 2000
// expands widely), bytes. GDCM allocates memory for an element by its stated 32-bit length before it reads the element.
// So without a limit, a file of 300 bytes could request 4 GB.
constexpr std::size_t kCodecMemory = 64 << 20;

struct Slice {
  std::size_t index = 0;  // index of the slice's file in VolumeLocation::headers
  Path path;
  std::string series;
  int rows = 0, columns = 0;
  glm::dvec3 position{0}, along_row{1, 0, 0}, along_column{0, 1, 0};
  glm::dvec2 spacing{1};  // distance between columns (x) and between rows (y), mm
  double thickness = 1;
  double slope = 1, intercept = 0;
  VoxelType type = VoxelType::Int16;
  bool has_position = false;

  std::int64_t bytes() const { return std::int64_t{rows} * columns * size_of(type); }
  glm::dvec3 normal() const { return glm::cross(along_row, along_column); }
};

// The functions of the shared library that contains GDCM (dicom_codec.h).
struct Codec {
  decltype(&limber_dicom_elements) elements;
  decltype(&limber_dicom_pixels) pixels;
};
const Codec& loaded_codec() {
  static const Codec loaded = [] {
    void* module = open_module("limber_dicom");
    Codec functions{nullptr, nullptr};
    if (!module) return functions;
    functions.elements = reinterpret_cast<decltype(&limber_dicom_elements)>(symbol_of(module, "limber_dicom_elements"));
    functions.pixels = reinterpret_cast<decltype(&limber_dicom_pixels)>(symbol_of(module, "limber_dicom_pixels"));
    return functions;
  }();
  return loaded;
}

const Codec& codec(const Path& path) {
  const Codec& loaded = loaded_codec();
  if (!loaded.elements || !loaded.pixels)
    throw Error("DICOM cannot be read, because limber_dicom.so is missing or damaged", path.string(),
                "install Limber again, or give NRRD, MetaImage or NIfTI");
  return loaded;
}

// Returns true if the file's pixels are not compressed. Its transfer syntax tells: three syntaxes are uncompressed
// (implicit element lengths, or explicit element lengths in either byte order).
bool is_plain(const PlainFile& file) {
  std::string start(2048, '\0');
  start.resize(file.read_at(0, start.data(), start.size()));
  constexpr std::string_view kSyntax("\x02\0\x10\0UI", 6);
  const std::size_t at = start.find(kSyntax);
  if (at == std::string::npos || at + 8 > start.size()) return false;
  const std::size_t size = static_cast<unsigned char>(start[at + 6]) + 256u * static_cast<unsigned char>(start[at + 7]);
  std::string syntax = start.substr(at + 8, size);
  while (!syntax.empty() && (syntax.back() == '\0' || is_blank(syntax.back()))) syntax.pop_back();
  return syntax == "1.2.840.10008.1.2" || syntax == "1.2.840.10008.1.2.1" || syntax == "1.2.840.10008.1.2.2";
}

// Throws Error when the file is too small to contain `bytes` bytes of pixels. Call this before memory is allocated for
// the pixels.
void check_pixels_fit(const PlainFile& file, const Path& path, std::int64_t bytes) {
  if (bytes > file.size() * (is_plain(file) ? 1 : kCodecMost))
    throw Error("the pixels of the DICOM image are missing or damaged", path.string(), "export the series again");
}

std::size_t memory_for(const PlainFile& file, std::size_t pixel_bytes) {
  return kCodecMemory + 4 * static_cast<std::size_t>(file.size()) + 16 * pixel_bytes;
}

LimberDicomFile file_for_codec(const PlainFile& file) {
  return {&file, file.size(), [](const void* context, std::int64_t offset, char* to, std::size_t size) {
            return static_cast<const PlainFile*>(context)->read_at(offset, to, size);
          }};
}

// Holds the data elements of a DICOM header, each of which can be read as text or as a 16-bit number.
class Elements {
  static constexpr std::size_t kLongest = 1024;  // size of the largest element that is kept, bytes

 public:
  Elements(const PlainFile& file, const Path& path) {
    const auto keep = [](void* context, std::uint16_t group, std::uint16_t element, const char* bytes,
                         std::size_t size) {
      if (size <= kLongest) static_cast<Elements*>(context)->values_[{group, element}].assign(bytes, size);
    };
    const LimberDicomFile read = file_for_codec(file);
    if (codec(path).elements(&read, keep, this) != 0)
      throw Error("the DICOM header is damaged", path.string(), "export the series again");
  }

  std::string text(std::uint16_t group, std::uint16_t element) const {
    const auto found = values_.find({group, element});
    if (found == values_.end()) return {};
    std::string text = found->second;
    while (!text.empty() && (text.back() == '\0' || is_blank(text.back()))) text.pop_back();
    return text;
  }
  std::optional<int> word(std::uint16_t group, std::uint16_t element) const {
    const auto found = values_.find({group, element});
    if (found == values_.end() || found->second.size() < 2) return std::nullopt;
    std::uint16_t number;
    std::memcpy(&number, found->second.data(), 2);
    return number;
  }
  // Returns the element's numbers, which are separated by backslashes. Returns an empty list unless the element has
  // exactly `count` numbers.
  std::vector<double> numbers(std::uint16_t group, std::uint16_t element, std::size_t count) const {
    std::string all = text(group, element);
    std::replace(all.begin(), all.end(), '\\', ' ');
    const auto numbers = numbers_of<double>(all);
    return numbers && numbers->size() == count ? *numbers : std::vector<double>{};
  }

 private:
  std::map<std::pair<std::uint16_t, std::uint16_t>, std::string> values_;
};

std::optional<VoxelType> type_of(int bits, bool is_signed) {
  if (bits == 8) return is_signed ? VoxelType::Int8 : VoxelType::UInt8;
  if (bits == 16) return is_signed ? VoxelType::Int16 : VoxelType::UInt16;
  if (bits == 32) return is_signed ? VoxelType::Int32 : VoxelType::UInt32;
  return std::nullopt;
}

Slice read_slice_header(VolumeFiles& files, std::size_t index) {
  const Path& path = files.location().headers[index];
  const PlainFile file = files.open_header(index);
  files.expect_memory(memory_for(file, 0));
  const Elements elements(file, path);

  Slice slice;
  slice.index = index;
  slice.path = path;
  slice.series = elements.text(0x0020, 0x000e);
  slice.rows = elements.word(0x0028, 0x0010).value_or(0);
  slice.columns = elements.word(0x0028, 0x0011).value_or(0);
  if (slice.rows < 1 || slice.columns < 1)
    throw Error("the DICOM file holds no image", path.string(), "keep only image files in the folder");
  if (elements.word(0x0028, 0x0002).value_or(1) != 1)
    throw Error("the DICOM image is in colour", path.string(), "export one label or grey value per voxel");
  if (number_of<int>(elements.text(0x0028, 0x0008)).value_or(1) > 1)
    throw Error("the DICOM file holds several frames", path.string(),
                "export it as a series of single images, or as NRRD or NIfTI");
  const auto type = type_of(elements.word(0x0028, 0x0100).value_or(0), elements.word(0x0028, 0x0103).value_or(0) == 1);
  if (!type)
    throw Error("the DICOM image has voxels that are not of 8, 16 or 32 bits", path.string(),
                "export the image with 16 bits");
  slice.type = *type;
  check_pixels_fit(file, path, slice.bytes());

  if (const auto p = elements.numbers(0x0020, 0x0032, 3); !p.empty()) {
    slice.position = {p[0], p[1], p[2]};
    slice.has_position = true;
  }
  if (const auto o = elements.numbers(0x0020, 0x0037, 6); !o.empty()) {
    slice.along_row = {o[0], o[1], o[2]};
    slice.along_column = {o[3], o[4], o[5]};
  }
  // DICOM stores the distance between rows first, then the distance between columns.
  for (const auto& spacing : {elements.numbers(0x0018, 0x1164, 2), elements.numbers(0x0028, 0x0030, 2)})
    if (!spacing.empty()) slice.spacing = {spacing[1], spacing[0]};
  for (const auto& thickness : {elements.numbers(0x0018, 0x0050, 1), elements.numbers(0x0018, 0x0088, 1)})
    if (!thickness.empty() && thickness[0] != 0) slice.thickness = thickness[0];
  if (const auto slope = elements.numbers(0x0028, 0x1053, 1); !slope.empty() && slope[0] != 0) slice.slope = slope[0];
  if (const auto intercept = elements.numbers(0x0028, 0x1052, 1); !intercept.empty()) slice.intercept = intercept[0];
  check_scale(slice.slope, slice.intercept, path.string());
  return slice;
}

// Reads the headers of all slices and sorts the slices along their normal. Throws Error when they belong to several
// series.
std::vector<Slice> read_series(VolumeFiles& files) {
  const Path& folder = files.location().path;
  std::map<std::string, std::vector<Slice>> by_series;
  for (std::size_t i = 0; i < files.location().headers.size(); ++i) {
    Slice slice = read_slice_header(files, i);
    by_series[slice.series].push_back(std::move(slice));
  }
  if (by_series.size() > 1) {
    std::string counts;
    for (const auto& [uid, slices] : by_series) counts += (counts.empty() ? "" : ", ") + std::to_string(slices.size());
    throw Error(
        "the folder holds " + std::to_string(by_series.size()) + " DICOM series (" + counts.substr(0, 60) + " images)",
        folder.string(), "keep one series in the folder");
  }
  std::vector<Slice> slices = std::move(by_series.begin()->second);
  const glm::dvec3 normal = slices.front().normal();
  std::stable_sort(slices.begin(), slices.end(), [&](const Slice& a, const Slice& b) {
    return glm::dot(a.position, normal) < glm::dot(b.position, normal);
  });
  return slices;
}

void check_alike(const std::vector<Slice>& slices, const Path& path) {
  const Slice& first = slices.front();
  for (const Slice& slice : slices) {
    const bool alike = slice.rows == first.rows && slice.columns == first.columns && slice.type == first.type &&
                       glm::length(slice.along_row - first.along_row) < 1e-3 &&
                       glm::length(slice.along_column - first.along_column) < 1e-3 &&
                       glm::length(slice.spacing - first.spacing) < 1e-3 * glm::length(first.spacing);
    if (!alike)
      throw Error("the images of the series differ in size, type, spacing or direction", slice.path.string(),
                  "keep one stack of images in " + path.string());
    if (slices.size() > 1 && !slice.has_position)
      throw Error("the DICOM image has no position", slice.path.string(), "export the series again");
  }
}

// Returns the vector from one slice to the next, mm. Throws Error when the gaps between slices are not equal.
glm::dvec3 slice_step(const std::vector<Slice>& slices, const Path& path) {
  const Slice& first = slices.front();
  const glm::dvec3 normal = glm::normalize(first.normal());
  if (slices.size() == 1) return normal * first.thickness;
  const glm::dvec3 step = (slices.back().position - first.position) / static_cast<double>(slices.size() - 1);
  const double mean = glm::dot(step, normal);
  for (std::size_t i = 1; i < slices.size(); ++i) {
    const double gap = glm::dot(slices[i].position - slices[i - 1].position, normal);
    if (!(std::abs(gap - mean) <= kEvenGaps * mean) || !(mean > 0))
      throw Error("the slices are not evenly spaced (" + text_of(std::round(gap * 1000) / 1000) + " mm where " +
                      text_of(std::round(mean * 1000) / 1000) + " mm is the mean)",
                  slices[i].path.string(), "an image is missing or doubled in " + path.string());
  }
  return step;
}

class DicomSource final : public VoxelSource {
 public:
  DicomSource(std::shared_ptr<VolumeFiles> files, std::vector<Slice> slices, bool scale)
      : files_(std::move(files)),
        slices_(std::move(slices)),
        scale_(scale) {}

  void read(void* to, std::size_t bytes) override {
    auto* out = static_cast<char*>(to);
    while (bytes > 0) {
      if (place_ == buffer_.size()) decode_next();
      const std::size_t now = std::min(bytes, buffer_.size() - place_);
      std::memcpy(out, buffer_.data() + place_, now);
      place_ += now;
      out += now;
      bytes -= now;
    }
  }
  std::vector<std::string> finish() override { return {}; }

 private:
  void decode_next() {
    const Slice& slice = slices_.at(next_++);
    const auto bytes = static_cast<std::size_t>(slice.bytes());
    const PlainFile file = files_->open_header(slice.index);
    files_->expect_memory(memory_for(file, bytes));
    buffer_.resize(bytes);
    const LimberDicomFile read = file_for_codec(file);
    if (codec(slice.path).pixels(&read, buffer_.data(), bytes) != 0)
      throw Error("the pixels of the DICOM image are missing or damaged", slice.path.string(),
                  "export the series again");
    if (scale_) to_float(slice);
    place_ = 0;
  }
  // Replaces the stored values of a slice by slope * stored + intercept, as floats. Used for a series whose slices
  // differ in slope or intercept.
  void to_float(const Slice& slice) {
    std::vector<char> scaled(static_cast<std::size_t>(std::int64_t{slice.rows} * slice.columns) * sizeof(float));
    visit_voxel_type(slice.type, [&]<class T>(T) {
      for (std::size_t i = 0; i < scaled.size() / sizeof(float); ++i) {
        T stored;
        std::memcpy(&stored, buffer_.data() + i * sizeof(T), sizeof(T));
        const auto value = static_cast<float>(static_cast<double>(stored) * slice.slope + slice.intercept);
        std::memcpy(scaled.data() + i * sizeof(float), &value, sizeof(float));
      }
    });
    buffer_ = std::move(scaled);
  }

  std::shared_ptr<VolumeFiles> files_;
  std::vector<Slice> slices_;
  bool scale_;
  std::vector<char> buffer_;
  std::size_t place_ = 0, next_ = 0;
};

OpenedVolume open_slices(std::shared_ptr<VolumeFiles> files, std::vector<Slice> slices) {
  const Path& path = files->location().path;
  check_alike(slices, path);
  const Slice& first = slices.front();
  const bool same_scale = std::all_of(slices.begin(), slices.end(), [&](const Slice& s) {
    return s.slope == first.slope && s.intercept == first.intercept;
  });
  VolumeHeader header;
  header.format = "DICOM";
  header.voxel_type = same_scale ? first.type : VoxelType::Float32;
  if (same_scale) {
    header.slope = first.slope;
    header.intercept = first.intercept;
  }
  const std::vector<std::int64_t> sizes = {first.columns, first.rows, static_cast<std::int64_t>(slices.size())};
  for (double spacing : {first.spacing.x, first.spacing.y, first.thickness})
    if (!(spacing > 0))
      throw Error("the spacing is " + text_of(spacing) + " mm", first.path.string(),
                  "spacing must be positive; export the series again");
  glm::dmat3 columns(first.along_row * first.spacing.x, first.along_column * first.spacing.y, slice_step(slices, path));
  header.grid = checked_grid(grid_from_columns(sizes, columns, first.position), path.string(), header.warnings);
  return {header, std::make_unique<DicomSource>(std::move(files), std::move(slices), !same_scale)};
}
}  // namespace

bool is_dicom_file(const Path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return false;
  try {
    char start[132];
    return PlainFile(path).read_at(0, start, sizeof start) == sizeof start && std::memcmp(start + 128, "DICM", 4) == 0;
  } catch (const Error&) {
    return false;
  }
}

bool is_dicom_folder(const Path& path) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(path, error))
    if (is_dicom_file(entry.path())) return true;
  return false;
}

std::vector<Path> dicom_files(const Path& folder) {
  std::vector<Path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    std::error_code error;
    if (!entry.is_regular_file(error) || !is_dicom_file(entry.path())) continue;
    if (files.size() == kMostFiles)
      throw Error("the folder holds more than 100 000 DICOM files", folder.string(), "keep one series in the folder");
    files.push_back(entry.path());
  }
  if (files.empty())
    throw Error("the folder holds no DICOM image", folder.string(), "name a volume file, or a folder with one series");
  std::sort(files.begin(), files.end());
  return files;
}

bool load_dicom_library() { return loaded_codec().elements != nullptr; }

OpenedVolume open_dicom(std::shared_ptr<VolumeFiles> files) {
  std::vector<Slice> slices = read_series(*files);
  return open_slices(std::move(files), std::move(slices));
}

}  // namespace limber
