// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/carved_chunks.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <string_view>
#include <utility>

#include "core/base/error.h"
#include "core/base/parallel.h"

namespace limber {

namespace {

constexpr unsigned char kTableLeaf = 0x0d, kIndexLeaf = 0x0a, kIndexInterior = 0x02;
constexpr std::int64_t kHashType = 12 + 2 * 32;  // SQLite's serial type of a blob of 32 bytes
constexpr std::uint32_t kMostPayload = (16u << 20) + (1u << 20);
constexpr std::int64_t kBatch = 32;     // number of chunks that are unpacked in parallel
constexpr std::size_t kLeastCell = 38;  // size of the smallest row of the chunk table, bytes
// Upper limit on the bytes that a scan reads, as a multiple of the file's size. In an intact file no two rows share an
// overflow page, so only a hostile file exceeds the limit.
constexpr std::int64_t kMostReading = 4;
constexpr std::array<std::string_view, 5> kStates = {"root", "mark", "editor", "thumbnail", "program"};

std::uint32_t big_endian(const char* bytes, int count) {
  std::uint32_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

// Reads a variable-length integer of SQLite (one to nine bytes) and moves `at` behind it. Returns nothing where the
// bytes end before the integer does.
std::optional<std::int64_t> varint(std::string_view bytes, std::size_t& at) {
  std::uint64_t value = 0;
  for (int i = 0; i < 9; ++i) {
    if (at >= bytes.size()) return std::nullopt;
    const auto byte = static_cast<unsigned char>(bytes[at++]);
    if (i == 8) return static_cast<std::int64_t>(value << 8 | byte);
    value = value << 7 | (byte & 0x7f);
    if (!(byte & 0x80)) break;
  }
  return static_cast<std::int64_t>(value);
}

// Returns how many bytes of a row's payload SQLite stores in the row's own page. The other bytes are in overflow pages.
//   usable  number of bytes of a page that SQLite uses
//   index   true: the row is in an index, false: in a table
std::uint32_t local_bytes(std::uint32_t payload, std::int64_t usable, bool index) {
  const std::int64_t most = index ? (usable - 12) * 64 / 255 - 23 : usable - 35, least = (usable - 12) * 32 / 255 - 23;
  if (payload <= most) return payload;
  const std::int64_t fitting = least + (payload - least) % (usable - 4);
  return static_cast<std::uint32_t>(fitting <= most ? fitting : least);
}

// The SQLite types of the columns of a record that has two columns.
struct TwoColumns {
  std::int64_t first_type, second_type;
  std::size_t header;  // size of the record's header, bytes
  static std::int64_t blob_bytes(std::int64_t type) { return type >= 12 && type % 2 == 0 ? (type - 12) / 2 : -1; }
};
std::optional<TwoColumns> two_columns(std::string_view record) {
  std::size_t at = 0;
  const auto header = varint(record, at), first = varint(record, at), second = varint(record, at);
  if (!header || !first || !second || *header != static_cast<std::int64_t>(at)) return std::nullopt;
  return TwoColumns{*first, *second, at};
}

}  // namespace

CarvedChunks::CarvedChunks(const Path& path, Progress& progress) : where_(path.string()) {
  std::error_code error;
  file_ = OpenFile(path, Opening::Read, error);
  if (error) throw Error("the project cannot be opened", where_, error.message());
  size_ = file_.size();
  bytes_left_ = kMostReading * size_;
  std::string header(100, '\0');
  if (size_ >= 100 && read_at(0, header.data(), header.size()) && header.starts_with("SQLite format 3")) {
    const std::uint32_t told = big_endian(header.data() + 16, 2);
    const std::int64_t bytes = told == 1 ? 65536 : told;
    if (bytes >= 512 && std::has_single_bit(static_cast<std::uint64_t>(bytes))) page_bytes_ = bytes;
  }
  scan(progress);
  keep_whole(progress);
}

bool CarvedChunks::read_at(std::int64_t offset, char* to, std::size_t size) const {
  return file_.read_at(offset, to, size) == size;
}

void CarvedChunks::scan(Progress& progress) {
  std::string page(static_cast<std::size_t>(page_bytes_), '\0');
  for (std::int64_t number = 1; number * page_bytes_ <= size_; ++number) {
    if (number % 256 == 1)
      progress.update("recover", .5 * static_cast<double>(number * page_bytes_) / static_cast<double>(size_));
    if (!read_at((number - 1) * page_bytes_, page.data(), page.size()))
      continue;  // a bad sector: the next page may still be readable
    const auto type = static_cast<unsigned char>(page[0]);
    if (type == kTableLeaf) scan_table_page(page, number);
    if (type == kIndexLeaf || type == kIndexInterior) scan_index_page(page);
  }
}

void CarvedChunks::scan_table_page(const std::string& page, std::int64_t number) {
  constexpr std::size_t kHeader = 8;
  const std::size_t count = std::min<std::size_t>(big_endian(page.data() + 3, 2), page.size() / kLeastCell);
  for (std::size_t i = 0; i < count; ++i) {
    std::size_t at = big_endian(page.data() + kHeader + 2 * i, 2);
    const auto payload = varint(page, at), rowid = varint(page, at);
    if (!payload || !rowid || *payload < 36 || *payload > kMostPayload) continue;
    const auto size = static_cast<std::uint32_t>(*payload);
    const std::uint32_t local = local_bytes(size, page_bytes_, false);
    if (at + local + (local < size ? 4 : 0) > page.size()) continue;
    const auto columns = two_columns(std::string_view(page).substr(at, local));
    if (!columns || columns->first_type != kHashType) continue;
    const std::int64_t blob = TwoColumns::blob_bytes(columns->second_type);
    if (blob < 0 || static_cast<std::int64_t>(columns->header) + 32 + blob != *payload) continue;
    if (columns->header + 32 > local) continue;
    ChunkHash hash;
    std::memcpy(hash.bytes.data(), page.data() + at + columns->header, hash.bytes.size());
    cells_[hash].push_back({*rowid, (number - 1) * page_bytes_ + static_cast<std::int64_t>(at), size, local});
  }
}

// Reads the rows of the state table on a page. SQLite stores this table as an index, since it is WITHOUT ROWID.
void CarvedChunks::scan_index_page(const std::string& page) {
  const bool interior = static_cast<unsigned char>(page[0]) == kIndexInterior;
  const std::size_t header = interior ? 12 : 8, count = big_endian(page.data() + 3, 2);
  for (std::size_t i = 0; i < count && header + 2 * i + 2 <= page.size(); ++i) {
    std::size_t at = big_endian(page.data() + header + 2 * i, 2) + (interior ? 4 : 0);
    const auto size = varint(page, at);
    if (!size || *size < 4 || *size > kMostPayload) continue;
    const std::uint32_t local = local_bytes(static_cast<std::uint32_t>(*size), page_bytes_, true);
    const bool overflows = local < *size;
    if (at + local + (overflows ? 4 : 0) > page.size()) continue;
    const auto columns = two_columns(std::string_view(page).substr(at, local));
    if (!columns) continue;
    const std::int64_t name = TwoColumns::blob_bytes(columns->first_type),
                       value = TwoColumns::blob_bytes(columns->second_type);
    if (name < 1 || name > 32 || value < 0 || static_cast<std::int64_t>(columns->header) + name + value != *size)
      continue;
    if (!may_read(static_cast<std::uint32_t>(*size))) return;
    const auto record = payload(page.substr(at, local), static_cast<std::uint32_t>(*size),
                                overflows ? big_endian(page.data() + at + local, 4) : 0);
    if (!record) continue;
    const auto behind_name = columns->header + static_cast<std::size_t>(name);
    const std::string key = record->substr(columns->header, static_cast<std::size_t>(name));
    if (std::find(kStates.begin(), kStates.end(), key) != kStates.end())
      states_.emplace(key, record->substr(behind_name));
  }
}

bool CarvedChunks::may_read(std::uint32_t bytes) { return (bytes_left_ -= bytes) >= 0; }

// Joins the payload's bytes on the row's own page (`local`) and those on the overflow pages, of which `next` is the
// first. Returns nothing where the chain of overflow pages ends early.
std::optional<std::string> CarvedChunks::payload(const std::string& local, std::uint32_t size,
                                                 std::uint32_t next) const {
  std::string bytes = local;
  std::string page(static_cast<std::size_t>(page_bytes_), '\0');
  while (bytes.size() < size) {
    if (next < 2 || next * page_bytes_ > size_) return std::nullopt;
    if (!read_at((static_cast<std::int64_t>(next) - 1) * page_bytes_, page.data(), page.size())) return std::nullopt;
    next = big_endian(page.data(), 4);
    bytes.append(page, 4, std::min<std::size_t>(page.size() - 4, size - bytes.size()));
  }
  return bytes;
}

std::optional<std::string> CarvedChunks::packed(const Cell& cell) const {
  std::string local(cell.local + (cell.local < cell.payload ? 4 : 0), '\0');
  if (!read_at(cell.offset, local.data(), local.size())) return std::nullopt;
  const std::uint32_t next = cell.local < cell.payload ? big_endian(local.data() + cell.local, 4) : 0;
  local.resize(cell.local);
  auto record = payload(local, cell.payload, next);
  const auto columns = record ? two_columns(*record) : std::nullopt;
  if (!columns) return std::nullopt;
  return record->substr(columns->header + sizeof(ChunkHash));
}

// Drops every row whose chunk does not have the hash that the row gives. Several rows may give the same hash, since
// free pages keep old rows. In this case one row with an undamaged chunk is kept.
void CarvedChunks::keep_whole(Progress& progress) {
  std::vector<std::pair<ChunkHash, std::vector<Cell>>> all(cells_.begin(), cells_.end());
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) {
    return std::pair(b.second[0].rowid, b.first.bytes) < std::pair(a.second[0].rowid, a.first.bytes);
  });
  cells_.clear();
  for (std::int64_t first = 0; first < std::ssize(all); first += kBatch) {
    progress.update("recover", .5 + .5 * static_cast<double>(first) / static_cast<double>(all.size()));
    const std::int64_t batch = std::min(kBatch, std::ssize(all) - first);
    for (std::int64_t i = first; i < first + batch; ++i)
      std::erase_if(all[i].second, [&](const Cell& cell) { return !may_read(cell.payload); });
    parallel_for(batch, 1, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i) {
        auto& [hash, cells] = all[first + i];
        std::erase_if(cells, [&](const Cell& cell) {
          const auto bytes = packed(cell);
          return !bytes || !unpack(*bytes, hash);
        });
      }
    });
    for (std::int64_t i = first; i < first + batch; ++i) {
      if (all[i].second.empty()) continue;
      all[i].second.resize(1);
      latest_first_.push_back(all[i].first);
      cells_.insert(std::move(all[i]));
    }
  }
}

std::optional<std::string> CarvedChunks::find(const ChunkHash& hash) {
  if (const auto found = cells_.find(hash); found != cells_.end()) return packed(found->second[0]);
  for (const auto& other : others_)
    if (auto bytes = other->find(hash)) return bytes;
  return std::nullopt;
}

std::optional<std::string> CarvedChunks::state(const std::string& name) const {
  const auto found = states_.find(name);
  return found == states_.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace limber
