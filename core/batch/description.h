// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads the values of the JSON file that describes a study or batch. Paths are relative to the file's folder. Every
// function throws Error for a wrong value; the message contains the file and the position of the value.
#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/batch/described_body.h"
#include "core/batch/described_pose.h"
#include "core/batch/technique.h"

namespace limber {

// A value of the file: the whole description, or a part of it. Copies share the file's contents.
class Description {
 public:
  // Reads the file, whose value must be an object.
  //   what  "study" or "batch", for messages
  Description(const Path& file, const std::string& what);

  bool is_object() const;
  bool is_null() const;
  bool has(const std::string& key) const;

  // Throws Error unless all keys of the object are in `known`.
  void check_keys(const std::set<std::string>& known) const;
  // Returns the text under a key, or `otherwise` if the key is absent. Unless `words` is empty, the text must be one of
  // them.
  std::string text(const std::string& key, const std::string& otherwise = "",
                   const std::set<std::string>& words = {}) const;
  // Returns the path under a key, or an empty path if the key is absent. Throws Error if the file does not exist.
  Path file(const std::string& key) const;
  // Returns the number under a key, in [least, most], or nothing if the key is absent.
  std::optional<double> number(const std::string& key, double least, double most) const;
  bool flag(const std::string& key) const;
  // Returns the texts under a key, whose value may be one text or a list of texts. Empty if the key is absent.
  std::vector<std::string> texts(const std::string& key) const;
  // Returns the values of the list under a key, or none if the key is absent. Throws Error if the value is not a list,
  // or an empty list.
  std::vector<Description> list(const std::string& key) const;
  // Returns the object under a key. The key must exist: see has().
  Description object(const std::string& key) const;

  // Return this value as a text that is not empty, or as a number in [least, most].
  std::string as_text() const;
  double as_number(double least, double most) const;

  [[noreturn]] void refuse(const std::string& what, const std::string& what_to_do) const;
  // Throws Error that says what is wrong (`what`), the position of the value under a key, and what the user should do.
  [[noreturn]] void refuse(const std::string& what, const std::string& key, const std::string& what_to_do) const;
  std::string where(const std::string& key = "") const;  // text for messages: "FILE, poses, number 1, flex"

 private:
  struct File;
  Description(std::shared_ptr<const File> file, const void* value, std::string place);
  Path folder() const;
  Description at(const std::string& key) const;

  std::shared_ptr<const File> file_;
  const void* value_;  // the part's JSON value in the file
  std::string place_;  // position of the part in the file: "poses, number 1"; "" for the whole file
};

// Returns the poses under the key "poses" of a study or batch, with one pose for each frame of a sequence. Their names
// are distinct.
std::vector<DescribedPose> read_described_poses(const Description& description, const std::string& what);
// Returns the techniques under the key "methods", or `otherwise` if the key is absent.
std::vector<Technique> read_techniques(const Description& description, const std::vector<std::string>& otherwise);
// Reads those keys of a body that studies and batches have in common: volume, phantom, rig, tissues and bones.
DescribedBody read_described_body(const Description& description, const std::string& whose);
// Returns the value of the key "nearest". Throws Error if it is true although a technique makes masses exact.
bool read_nearest(const Description& description, const std::vector<Technique>& techniques);
// Throws Error if two of the values under a key are equal.
void check_distinct(const Description& description, const std::string& key, std::vector<std::string> values);

}  // namespace limber
