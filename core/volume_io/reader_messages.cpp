// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume_io/reader_messages.h"

#include <algorithm>
#include <array>

#include "core/volume_io/volume_format.h"

namespace limber {

namespace {

using Damaged = std::function<void()>;

constexpr int kVoxelTypes = 10, kEncodings = 5, kHoldings = 4, kTissueKinds = static_cast<int>(TissueKind::Nail) + 1;

void put(ByteWriter& out, const std::vector<std::string>& texts) {
  out.count(texts.size());
  for (const std::string& text : texts) out.text(text);
}

std::vector<std::string> texts_of(ByteReader& in) {
  std::vector<std::string> texts(in.count(sizeof(std::uint32_t)));
  for (std::string& text : texts) text = in.text();
  return texts;
}

void put(ByteWriter& out, const Grid& grid) {
  for (int axis = 0; axis < 3; ++axis) {
    out.put(grid.size[axis]);
    out.put(grid.spacing[axis]);
    out.put(grid.origin[axis]);
    for (int row = 0; row < 3; ++row) out.put(grid.direction[axis][row]);
  }
}

Grid grid_of(ByteReader& in) {
  Grid grid;
  for (int axis = 0; axis < 3; ++axis) {
    grid.size[axis] = in.get<int>();
    grid.spacing[axis] = in.get<double>();
    grid.origin[axis] = in.get<double>();
    for (int row = 0; row < 3; ++row) grid.direction[axis][row] = in.get<double>();
  }
  return grid;
}

void put(ByteWriter& out, const Tissue& tissue) {
  out.put(tissue.label);
  out.put(tissue.file_value);
  out.text(tissue.name);
  for (int channel = 0; channel < 3; ++channel) out.put(tissue.colour[channel]);
  out.put(static_cast<std::uint8_t>(tissue.kind));
  out.put(tissue.density);
  out.put(tissue.young_modulus);
  out.put(tissue.poisson_ratio);
  out.put(tissue.priority);
}

Tissue tissue_of(ByteReader& in) {
  Tissue tissue;
  tissue.label = in.get<Label>();
  tissue.file_value = in.get<double>();
  tissue.name = in.text();
  for (int channel = 0; channel < 3; ++channel) tissue.colour[channel] = in.get<float>();
  tissue.kind = static_cast<TissueKind>(in.get_below<std::uint8_t>(kTissueKinds));
  tissue.density = in.get<double>();
  tissue.young_modulus = in.get<double>();
  tissue.poisson_ratio = in.get<double>();
  tissue.priority = in.get<int>();
  return tissue;
}

void put(ByteWriter& out, const TissueTable& table) {
  out.text(table.source);
  out.count(table.tissues.size());
  for (const Tissue& tissue : table.tissues) put(out, tissue);
}

TissueTable table_of(ByteReader& in) {
  constexpr std::size_t kLeastBytes = 50;  // bytes of the smallest encoded tissue, one without a name
  TissueTable table;
  table.source = in.text();
  table.tissues.resize(in.count(kLeastBytes));
  for (Tissue& tissue : table.tissues) tissue = tissue_of(in);
  return table;
}

// Repeats the checks of the parsers and throws when the header fails one. The checks may correct a grid, so a header
// whose grid they would change was never checked and fails too.
void check(const VolumeHeader& header, const std::string& where, const ByteReader& in) {
  // The format in a header is the name of a known volume format, followed by at most two characters, as in "NIfTI-1".
  const auto formats = volume_formats();
  in.require(std::any_of(formats.begin(), formats.end(), [&](const VolumeFormat& format) {
    return header.format.starts_with(format.name) && header.format.size() <= format.name.size() + 2;
  }));
  const Grid& grid = header.grid;
  std::vector<std::string> known;
  const RawGrid raw{{grid.size.x, grid.size.y, grid.size.z}, grid.spacing, grid.origin, grid.direction};
  in.require(checked_grid(raw, where, known) == grid);
  check_scale(header.slope, header.intercept, where);
}

}  // namespace

std::string bytes_of(const Order& order) {
  ByteWriter out;
  out.text(order.location.path.string());
  out.flag(order.location.is_dicom);
  out.put(static_cast<std::uint8_t>(order.holding));
  out.count(order.location.headers.size());
  for (const Path& header : order.location.headers) out.text(header.string());
  return out.take();
}

Order order_from(std::string_view bytes, const Damaged& damaged) {
  ByteReader in(bytes, damaged);
  Order order;
  order.location.path = in.text();
  order.location.is_dicom = in.flag();
  order.holding = static_cast<Holding>(in.get_below<std::uint8_t>(kHoldings));
  for (std::string& header : texts_of(in)) order.location.headers.emplace_back(std::move(header));
  in.require(!order.location.headers.empty());
  in.end();
  return order;
}

std::string bytes_of(const Protection& protection) {
  ByteWriter out;
  out.put(kMessageVersion);
  out.flag(protection.own_process);
  out.flag(protection.system_calls);
  out.put(protection.landlock);
  return out.take();
}

Protection protection_from(std::string_view bytes, const Damaged& damaged) {
  ByteReader in(bytes, damaged);
  in.require(in.get<std::uint32_t>() == kMessageVersion);
  Protection protection;
  protection.own_process = in.flag();
  protection.system_calls = in.flag();
  protection.landlock = in.get<int>();
  in.end();
  return protection;
}

std::string bytes_of(const VolumeHeader& header) {
  ByteWriter out;
  out.text(header.format);
  out.put(static_cast<std::uint8_t>(header.voxel_type));
  put(out, header.grid);
  out.put(static_cast<std::uint8_t>(header.encoding));
  out.flag(header.big_endian);
  out.put(header.slope);
  out.put(header.intercept);
  put(out, header.data_names);
  out.count(header.keys.size());
  for (const auto& [key, value] : header.keys) {
    out.text(key);
    out.text(value);
  }
  put(out, header.named);
  put(out, header.warnings);
  return out.take();
}

VolumeHeader header_from(std::string_view bytes, const std::string& where, const Damaged& damaged) {
  ByteReader in(bytes, damaged);
  VolumeHeader header;
  header.format = in.text();
  header.voxel_type = static_cast<VoxelType>(in.get_below<std::uint8_t>(kVoxelTypes));
  header.grid = grid_of(in);
  header.encoding = static_cast<Encoding>(in.get_below<std::uint8_t>(kEncodings));
  header.big_endian = in.flag();
  header.slope = in.get<double>();
  header.intercept = in.get<double>();
  header.data_names = texts_of(in);
  for (std::size_t left = in.count(2 * sizeof(std::uint32_t)); left > 0; --left) {
    std::string key = in.text();
    header.keys[std::move(key)] = in.text();
  }
  header.named = table_of(in);
  header.warnings = texts_of(in);
  in.end();
  check(header, where, in);
  return header;
}

std::string bytes_of(const std::vector<std::string>& texts) {
  ByteWriter out;
  put(out, texts);
  return out.take();
}

std::vector<std::string> texts_from(std::string_view bytes, const Damaged& damaged) {
  ByteReader in(bytes, damaged);
  std::vector<std::string> texts = texts_of(in);
  in.end();
  return texts;
}

}  // namespace limber
