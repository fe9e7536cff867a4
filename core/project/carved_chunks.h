// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the chunks of a damaged project file without the structure of its database. The scan reads every page on its
// own. It follows whatever looks like a row of the chunk table through the row's overflow pages, and accepts only bytes
// whose SHA-256 is the hash in that row. So a lost page costs only the chunks that it held. The file is only read.
//
// The file format is SQLite's: "Database File Format", sections 1.5 and 1.6 (sqlite.org/fileformat2.html).
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/base/file.h"
#include "core/base/progress.h"
#include "core/platform/open_file.h"
#include "core/project/chunk.h"

namespace limber {

class CarvedChunks final : public ChunkSource {
 public:
  // Reads the file twice and reports progress as stage "recover". Throws Error when the file cannot be read.
  explicit CarvedChunks(const Path& path, Progress& progress = no_progress());
  CarvedChunks(const CarvedChunks&) = delete;
  CarvedChunks& operator=(const CarvedChunks&) = delete;

  // Returns the compressed chunk from this file or from an added source, or nothing where the chunk is damaged in all
  // of them.
  std::optional<std::string> find(const ChunkHash& hash) override;
  // Adds a source for the chunks that are lost in this file: an earlier copy, or the files that the project was made
  // from.
  void add(std::unique_ptr<ChunkSource> other) { others_.push_back(std::move(other)); }
  // Returns the hashes of all undamaged chunks of this file, the last written first.
  const std::vector<ChunkHash>& latest_first() const { return latest_first_; }
  // Returns the value of a row of the state table ("root", "editor", ...), or nothing when the row is lost.
  std::optional<std::string> state(const std::string& name) const;

 private:
  struct Cell {                    // a row of the chunk table
    std::int64_t rowid, offset;    // offset of the payload in the file, bytes
    std::uint32_t payload, local;  // bytes of the whole payload; bytes of the payload on the row's own page
  };
  void scan(Progress& progress);
  void scan_table_page(const std::string& page, std::int64_t number);
  void scan_index_page(const std::string& page);
  void keep_whole(Progress& progress);
  bool read_at(std::int64_t offset, char* to, std::size_t size) const;
  std::optional<std::string> payload(const std::string& local, std::uint32_t size, std::uint32_t next_page) const;
  std::optional<std::string> packed(const Cell& cell) const;
  bool may_read(std::uint32_t bytes);

  std::string where_;
  OpenFile file_;
  std::int64_t size_ = 0, page_bytes_ = 8192;
  // Payload bytes that may still be read. They are limited because the rows of a hostile file may share pages.
  std::int64_t bytes_left_ = 0;
  // Rows by hash; keep_whole() leaves one for each hash.
  std::unordered_map<ChunkHash, std::vector<Cell>, ChunkHash::Hasher> cells_;
  std::vector<ChunkHash> latest_first_;
  std::map<std::string, std::string> states_;
  std::vector<std::unique_ptr<ChunkSource>> others_;
};

}  // namespace limber
