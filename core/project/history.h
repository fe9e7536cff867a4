// SPDX-License-Identifier: AGPL-3.0-or-later
// Undo and redo: a line of documents, each with the label of the edit that made it. Documents share their parts, so a
// step costs what it changed. Memory is bounded: when the distinct parts of the line (weights by brick, a volume once)
// take more than the limit, the oldest states go, and note() says so. The limit counts the current document too, but
// leaves at least half of itself to the others, so that a large volume does not take undo away.
//
// One thread owns a History.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/project/document.h"

namespace limber {

class History {
 public:
  static constexpr std::int64_t kDefaultLimit = std::int64_t{1} << 30;  // bytes

  struct Step {
    std::string label;  // of the edit that made it: "Paint weights"
    Document document;
    std::int64_t revision;  // of this state alone, never given again
  };

  explicit History(Document first = {}, std::string label = "New project", std::int64_t limit_bytes = kDefaultLimit);
  ~History();
  History(const History&) = delete;
  History& operator=(const History&) = delete;

  const Document& current() const { return steps_[position_].document; }
  std::int64_t revision() const { return steps_[position_].revision; }

  // Makes `next` current and forgets what could be redone. False, and nothing happens, when it equals the current
  // document (the same parts).
  bool commit(std::string label, Document next);
  // In place of the current step, which becomes what it would have been at once: for many small steps of one deed. It
  // is then the last step.
  void amend(std::string label, Document next);
  // Another project: one step that counts as saved.
  void reset(Document first, std::string label);

  bool can_undo() const { return position_ > 0; }
  bool can_redo() const { return position_ + 1 < std::ssize(steps_); }
  bool undo();  // false when there is nothing to undo
  bool redo();
  void jump(std::int64_t step);  // [0, #steps)

  // Oldest first; `position` is the current one.
  const std::vector<Step>& steps() const { return steps_; }
  std::int64_t position() const { return position_; }

  // The state that was saved, which may no longer be the current one when the saving ends.
  void mark_saved(std::int64_t revision) { saved_ = revision; }
  void mark_unsaved() { saved_ = -1; }  // as after a recovery
  bool unsaved() const { return revision() != saved_; }

  // Bytes of all distinct parts of all steps, and of the current document's alone.
  std::int64_t bytes() const;
  std::int64_t current_bytes() const;
  std::int64_t limit() const { return limit_; }
  void set_limit(std::int64_t bytes);
  std::int64_t dropped() const { return dropped_; }
  std::string note() const;  // "The 12 oldest steps were dropped to stay within 64 MB." or ""

 private:
  class Ledger;
  void keep_within_limit();

  std::vector<Step> steps_;
  std::int64_t position_ = 0, next_revision_ = 1, saved_ = 0, limit_, dropped_ = 0;
  std::unique_ptr<Ledger> ledger_;
};

// Bytes of a document's distinct parts.
std::int64_t bytes_of(const Document& document);

}  // namespace limber
