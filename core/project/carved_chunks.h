// SPDX-License-Identifier: AGPL-3.0-or-later
// Chunks of a damaged project file, found without its database's structure: every page is looked at by itself, what
// looks like a row of the table of chunks is followed through its overflow pages, and only bytes that have their name's
// hash are believed. So lost pages cost the chunks that lay in them, and no others. The file is only read.
//
// The format is SQLite's, "Database File Format", sections 1.5 and 1.6 (sqlite.org/fileformat2.html).
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
#include "core/project/chunk.h"

namespace limber {

class CarvedChunks final : public ChunkSource {
 public:
  // Reads the file twice; tells `progress` of stage "recover". throws Error when the file cannot be read
  explicit CarvedChunks(const Path& path, Progress& progress = no_progress());
  ~CarvedChunks() override;
  CarvedChunks(const CarvedChunks&) = delete;
  CarvedChunks& operator=(const CarvedChunks&) = delete;

  // Packed; nothing unless it is whole, here or in what was added.
  std::optional<std::string> find(const ChunkHash& hash) override;
  // Chunks from elsewhere take the place of those that are lost here: of an earlier copy, or of what the project was
  // made from.
  void add(std::unique_ptr<ChunkSource> other) { others_.push_back(std::move(other)); }
  // All that are whole, those first that were written last.
  const std::vector<ChunkHash>& latest_first() const { return latest_first_; }
  // A row of the table of states ("root", "editor", ...), where it is left.
  std::optional<std::string> state(const std::string& name) const;

 private:
  struct Cell {                    // a row of the table of chunks
    std::int64_t rowid, offset;    // of its payload in the file
    std::uint32_t payload, local;  // bytes in all, and in the page itself
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
  int descriptor_ = -1;
  std::int64_t size_ = 0, page_bytes_ = 8192;
  std::int64_t bytes_left_ = 0;  // to be read of payloads: rows of a hostile file may share their pages
  std::unordered_map<ChunkHash, std::vector<Cell>, ChunkHash::Hasher> cells_;  // after keep_whole() one each
  std::vector<ChunkHash> latest_first_;
  std::map<std::string, std::string> states_;
  std::vector<std::unique_ptr<ChunkSource>> others_;
};

}  // namespace limber
