// SPDX-License-Identifier: AGPL-3.0-or-later
// Undo and redo: a list of documents, each with the label of the edit that made it. Documents share their parts, so a
// step costs only what it changed. Memory is limited: when the distinct parts of all steps (weights by brick, a volume
// once) exceed the limit, the label volumes of other steps are first replaced by the differences that edits made
// (packed_volumes.h). If that is not enough, the oldest steps are dropped, and note() says so. The current document
// counts too, but the other steps may always use half of the limit, so that a large volume does not disable undo.
//
// Only one thread may use a History.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/project/document.h"

namespace limber {

class History {
 public:
  static constexpr std::int64_t kDefaultLimit = std::int64_t{1} << 30;  // limit on the memory of all steps, bytes

  struct Step {
    std::string label;  // the edit that made the document, such as "Paint weights"
    Document document;
    std::int64_t revision;  // unique number of this document state
  };

  explicit History(Document first = {}, std::string label = "New project", std::int64_t limit_bytes = kDefaultLimit);
  ~History();
  History(const History&) = delete;
  History& operator=(const History&) = delete;

  const Document& current() const { return steps_[position_].document; }
  std::int64_t revision() const { return steps_[position_].revision; }

  // Makes `next` current and forgets all steps that could be redone. Returns false and does nothing when `next` has
  // the same parts as the current document.
  bool commit(std::string label, Document next);
  // Replaces the current step by `next` and forgets all steps that could be redone. So a series of small edits, such as
  // a drag, becomes one step.
  void amend(std::string label, Document next);
  // Replaces the whole history by one step with the first document of another project. That step counts as saved.
  void reset(Document first, std::string label);

  bool can_undo() const { return position_ > 0; }
  bool can_redo() const { return position_ + 1 < std::ssize(steps_); }
  bool undo();  // returns false when there is nothing to undo
  bool redo();
  void jump(std::int64_t step);  // makes the step with this index current, [0, number of steps)

  // The steps, oldest first; position() is the index of the current one. The documents of other steps may be without
  // their volume.
  const std::vector<Step>& steps() const { return steps_; }
  std::int64_t position() const { return position_; }

  // Marks the state with this revision as saved. When a save ends, later edits may already have made another state
  // current.
  void mark_saved(std::int64_t revision) { saved_ = revision; }
  void mark_unsaved() { saved_ = -1; }  // the current state counts as unsaved too, for example after a recovery
  bool unsaved() const { return revision() != saved_; }

  // bytes() returns the size of the distinct parts of all steps. current_bytes() returns the size of the current
  // document's parts alone.
  std::int64_t bytes() const;
  std::int64_t current_bytes() const;
  std::int64_t limit() const { return limit_; }
  void set_limit(std::int64_t bytes);
  std::int64_t dropped() const { return dropped_; }
  std::string note() const;  // says how many steps were dropped: "The 12 oldest steps were dropped ..."; "" if none

 private:
  class Ledger;
  void go_to(std::int64_t step);
  void drop_redo();
  void pack_volumes();
  void keep_within_limit();

  std::vector<Step> steps_;
  std::int64_t position_ = 0, next_revision_ = 1, saved_ = 0, limit_, dropped_ = 0;
  std::unique_ptr<Ledger> ledger_;
};

// Returns the memory of a document, bytes. A part to which the document refers several times counts once.
std::int64_t bytes_of(const Document& document);

}  // namespace limber
