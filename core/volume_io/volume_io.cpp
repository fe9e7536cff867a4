// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume_io/volume_io.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/base/text_parse.h"
#include "core/platform/memory.h"
#include "core/platform/memory_pages.h"
#include "core/volume/label_pages.h"
#include "core/volume/neighbour_changes.h"
#include "core/volume_io/dicom.h"
#include "core/volume_io/label_decoder.h"
#include "core/volume_io/volume_format.h"
#include "core/volume_io/voxel_source.h"

namespace limber {

namespace {
// Number of voxels in a chunk. A chunk this small stays in a processor cache between reading and decoding.
constexpr std::size_t kChunkVoxels = 1 << 14;
constexpr std::size_t kPageVoxels = 1 << 11;  // number of labels in a memory page of 4 KB

void check_memory(const Grid& grid, std::int64_t bytes_per_voxel, const Path& path) {
  // The volume may use at most nine tenths of the free memory, so that a tenth is left for everything else.
  const double needed = static_cast<double>(grid.voxel_count()) * static_cast<double>(bytes_per_voxel);
  const double available = static_cast<double>(available_memory());
  if (needed > 0.9 * available)
    throw Error("the volume of " + std::to_string(grid.size.x) + " x " + std::to_string(grid.size.y) + " x " +
                    std::to_string(grid.size.z) + " voxels needs " + std::to_string(std::llround(needed / 1e6)) +
                    " MB, " + std::to_string(std::llround(available / 1e6)) + " MB are free",
                path.string(), "use a coarser spacing or a larger machine");
}

// Calls body(voxels, count, first) for every chunk of the volume. A chunk has `count` voxels, the first of which is
// voxel `first`, in native byte order.
template <class Body>
void for_chunks(OpenedVolume& opened, Progress& progress, const Body& body) {
  const VolumeHeader& header = opened.header;
  const int size = size_of(header.voxel_type);
  const std::int64_t voxels = header.grid.voxel_count();
  const bool swap = header.big_endian == (std::endian::native == std::endian::little);
  std::vector<std::uint64_t> chunk(kChunkVoxels * static_cast<std::size_t>(size) / sizeof(std::uint64_t) + 1);
  for (std::int64_t first = 0, turn = 0; first < voxels; first += kChunkVoxels, ++turn) {
    const auto count = static_cast<std::size_t>(std::min<std::int64_t>(kChunkVoxels, voxels - first));
    opened.voxels->read(chunk.data(), count * static_cast<std::size_t>(size));
    if (swap) swap_bytes(chunk.data(), count, size);
    body(chunk.data(), count, first);
    if (turn % 64 == 0) progress.update("read", static_cast<double>(first) / static_cast<double>(voxels));
  }
}

void append(std::vector<std::string>& lines, std::vector<std::string> more) {
  for (auto& line : more) lines.push_back(std::move(line));
}

FileType type_of(const VolumeHeader& header) {
  return {header.format, std::string(to_string(header.voxel_type)),
          header.encoding == Encoding::Deflate || header.encoding == Encoding::Bzip2};
}

Error no_label(LabelDecoder::Problem problem, double value, const Path& path) {
  if (problem == LabelDecoder::Problem::TooMany)
    return Error("more than 65 535 distinct labels", path.string(),
                 "this looks like a grey image; give a label volume");
  if (problem == LabelDecoder::Problem::TooLarge)
    return Error("the label " + text_of(value) + " is beyond 2^53", path.string(), "renumber the labels");
  return Error("the voxel value " + text_of(value) + " is not a whole number", path.string(),
               "this looks like a grey image or a weight; give a label volume");
}

const char* const kNoTissue = "every voxel is air (0)";
}  // namespace

TissueTable tissues_of_values(const std::vector<std::pair<Label, double>>& values, const TissueTable& named) {
  const FileValueIndex by_value(named);
  TissueTable table;
  table.source = named.source;
  for (const auto& [label, value] : values) {
    if (label == 0) continue;
    Tissue tissue;
    tissue.file_value = value;
    apply_kind_defaults(tissue);
    if (const Tissue* known = by_value.find(value)) tissue = *known;
    tissue.label = label;
    tissue.file_value = value;
    table.tissues.push_back(tissue);
  }
  return table;
}

VolumeFile read_volume(const Path& path, Progress& progress) {
  OpenedVolume opened = open_volume(path, progress);
  const VolumeHeader& header = opened.header;
  check_memory(header.grid, sizeof(Label), path);

  VolumeFile file{{header.grid, {}}, {}, type_of(header), header.warnings};
  LabelDecoder decoder;
  auto& voxels = file.volume.voxels;
  voxels.resize(static_cast<std::size_t>(header.grid.voxel_count()));
  want_large_pages(file.volume);
  for_chunks(opened, progress, [&](const void* chunk, std::size_t count, std::int64_t first) {
    const std::size_t voxel_bytes = static_cast<std::size_t>(size_of(header.voxel_type));
    for (std::size_t done = 0; done < count; done += kPageVoxels) {
      const std::size_t page = std::min(count - done, kPageVoxels);
      const char* from = static_cast<const char*>(chunk) + done * voxel_bytes;
      const auto decode = [&](std::size_t some, Label* to) {
        const auto problem = decoder.decode(from, some, header.voxel_type, header.slope, header.intercept, to);
        if (problem != LabelDecoder::Problem::None) throw no_label(problem, decoder.bad_value(), path);
      };
      // If all stored bytes of a page are zero, all its voxels have one label. If that label is air, the page is not
      // written: the new volume is already all air, and a page that is never written takes no memory.
      Label first_label = 1;
      if (is_all_zero(from, page * voxel_bytes)) decode(1, &first_label);
      if (first_label != 0) decode(page, &voxels[static_cast<std::size_t>(first) + done]);
    }
  });
  append(file.warnings, opened.voxels->finish());
  file.tissues = tissues_of_values(decoder.values(), header.named);
  if (file.tissues.tissues.empty())
    file.warnings.push_back(std::string(kNoTissue) + ": " + path.string() + ": there is nothing to pose");
  return file;
}

GreyVolume read_grey_volume(const Path& path, Progress& progress) {
  OpenedVolume opened = open_volume(path, progress);
  const VolumeHeader& header = opened.header;
  check_memory(header.grid, sizeof(float), path);

  GreyVolume grey{header.grid, {}, type_of(header), header.warnings};
  grey.voxels.reserve(static_cast<std::size_t>(header.grid.voxel_count()));
  for_chunks(opened, progress, [&](const void* chunk, std::size_t count, std::int64_t) {
    visit_voxel_type(header.voxel_type, [&]<class T>(T) {
      const T* values = static_cast<const T*>(chunk);
      for (std::size_t i = 0; i < count; ++i)
        grey.voxels.push_back(static_cast<float>(static_cast<double>(values[i]) * header.slope + header.intercept));
    });
  });
  append(grey.warnings, opened.voxels->finish());
  return grey;
}

VolumeSummary summarize_volume(const Path& path) {
  OpenedVolume opened = open_volume(path);
  const VolumeHeader& header = opened.header;
  VolumeSummary summary{header.grid,
                        type_of(header),
                        true,
                        false,
                        {},
                        std::numeric_limits<double>::infinity(),
                        -std::numeric_limits<double>::infinity(),
                        header.warnings};
  LabelDecoder decoder;
  std::vector<Label> labels(kChunkVoxels);
  std::vector<std::int64_t> count_of(65536);
  NeighbourChanges changes(header.grid.size.x);
  for_chunks(opened, no_progress(), [&](const void* chunk, std::size_t count, std::int64_t) {
    if (summary.is_label && decoder.decode(chunk, count, header.voxel_type, header.slope, header.intercept,
                                           labels.data()) == LabelDecoder::Problem::None) {
      for (std::size_t i = 0; i < count; ++i) ++count_of[labels[i]];
      changes.add(labels.data(), count);
    } else {
      summary.is_label = false;
    }
    visit_voxel_type(header.voxel_type, [&]<class T>(T) {
      const T* values = static_cast<const T*>(chunk);
      for (std::size_t i = 0; i < count; ++i) {
        const double value = static_cast<double>(values[i]) * header.slope + header.intercept;
        summary.minimum = value < summary.minimum ? value : summary.minimum;  // a NaN value is ignored
        summary.maximum = value > summary.maximum ? value : summary.maximum;
      }
    });
  });
  append(summary.warnings, opened.voxels->finish());
  const auto kinds =
      std::count_if(count_of.begin() + 1, count_of.end(), [](std::int64_t voxels) { return voxels > 0; });
  summary.looks_grey = !summary.is_label || changes.looks_grey(static_cast<std::size_t>(kinds));
  if (!summary.is_label) return summary;

  bool tissue = false;
  const FileValueIndex by_value(header.named);
  for (const auto& [label, value] : decoder.values()) {
    if (count_of[label] == 0) continue;
    const Tissue* known = by_value.find(value);
    summary.labels.push_back({value, count_of[label], known ? known->name : ""});
    tissue = tissue || label != 0;
  }
  std::sort(summary.labels.begin(), summary.labels.end(),
            [](const auto& a, const auto& b) { return a.value < b.value; });
  if (!tissue) summary.warnings.push_back(std::string(kNoTissue) + ": " + path.string() + ": there is nothing to pose");
  return summary;
}

WeightsSummary summarize_weights(const Path& path) {
  const OpenedVolume opened = open_volume(path, no_progress(), Holding::Weights);
  const auto bones = opened.header.keys.find(kWeightsKey);
  if (bones == opened.header.keys.end())
    throw Error("the file holds no weights", path.string(), "make them with `limber weights`");
  return {bones->second, opened.header.grid.size.y};
}

bool is_volume_path(const Path& path) {
  std::error_code unreadable;
  if (std::filesystem::is_directory(path, unreadable)) return is_dicom_folder(path);
  const std::string name = lower_case(path.filename().string());
  // A ".raw" file is a volume only when the .txt file that describes it exists.
  if (name.ends_with(".raw")) return std::filesystem::exists(Path(path).replace_extension(".txt"), unreadable);
  for (const VolumeFormat& format : volume_formats())
    for (const std::string& ending : format.endings)
      if (name.ends_with(ending)) return true;
  return name.ends_with(".txt") && is_virtual_family(path);
}

}  // namespace limber
