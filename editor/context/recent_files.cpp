// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/recent_files.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/json_text.h"

namespace limber::editor {

namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

constexpr std::size_t kMostRecents = 30;
constexpr std::size_t kMostFolders = 8;
constexpr std::uint64_t kLargestSettings = 4 << 20;  // a settings file that is larger is not read, bytes
constexpr const char* kSchema = "limber-remembered/1";

// Reads an entry of a JSON object into `value`. `value` keeps its content if the entry is missing or of another type.
template <class T>
void take(const Json& json, const char* key, T& value) {
  const auto found = json.find(key);
  if (found == json.end()) return;
  if constexpr (std::is_same_v<T, bool>) {
    if (found->is_boolean()) value = found->get<bool>();
  } else {
    if (found->is_number_integer()) value = found->get<T>();
  }
}

}  // namespace

void forget_recent(RecentFiles& recent_files, const Path& path) {
  std::erase_if(recent_files.recents, [&](const Recent& recent) { return recent.path == path; });
}

void add_recent(RecentFiles& recent_files, const Path& path, std::int64_t time) {
  forget_recent(recent_files, path);
  recent_files.recents.insert(recent_files.recents.begin(), {path, time});
  if (recent_files.recents.size() > kMostRecents) recent_files.recents.resize(kMostRecents);
}

void add_recent_folder(RecentFiles& recent_files, const Path& folder) {
  std::erase(recent_files.recent_folders, folder);
  recent_files.recent_folders.insert(recent_files.recent_folders.begin(), folder);
  if (recent_files.recent_folders.size() > kMostFolders) recent_files.recent_folders.resize(kMostFolders);
}

std::string read_settings_text(const Path& file, const std::string& schema, std::string& warning) {
  std::error_code error;
  if (!fs::exists(file, error)) return "";
  std::string text;
  try {
    text = read_file(file, kLargestSettings);
  } catch (const Error& failure) {
    warning = failure.what();
    return "";
  }
  const Json json = Json::parse(sound_json(text), nullptr, false);
  if (json.is_object() && json.value("schema", Json()) == schema) return text;
  fs::rename(file, file.string() + ".damaged", error);
  warning = Error("the settings file is damaged and was reset", file.string(),
                  "the old file is kept as " + file.filename().string() + ".damaged")
                .what();
  return "";
}

RecentFiles read_recent_files(const Path& file, std::string& warning) {
  RecentFiles recent_files;
  const std::string text = read_settings_text(file, kSchema, warning);
  if (text.empty()) return recent_files;
  const Json json = Json::parse(sound_json(text), nullptr, false);
  if (const auto list = json.find("recent"); list != json.end() && list->is_array())
    for (const Json& entry : *list) {
      if (!entry.is_object() || !entry.contains("path") || !entry["path"].is_string()) continue;
      Recent recent{entry["path"].get<std::string>()};
      take(entry, "time", recent.time);
      if (recent.path.is_absolute() && recent_files.recents.size() < kMostRecents)
        recent_files.recents.push_back(std::move(recent));
    }
  if (const auto folders = json.find("folders"); folders != json.end() && folders->is_object())
    for (const auto& [purpose, folder] : folders->items())
      if (folder.is_string()) recent_files.folders[purpose] = folder.get<std::string>();
  if (const auto list = json.find("recent_folders"); list != json.end() && list->is_array())
    for (const Json& folder : *list)
      if (folder.is_string() && Path(folder.get<std::string>()).is_absolute() &&
          recent_files.recent_folders.size() < kMostFolders)
        recent_files.recent_folders.push_back(folder.get<std::string>());
  take(json, "show_start", recent_files.show_start);
  take(json, "hidden_files", recent_files.hidden_files);
  take(json, "tour_step", recent_files.tour_step);
  recent_files.tour_step = std::max(recent_files.tour_step, 0);
  return recent_files;
}

void write_recent_files(const RecentFiles& recent_files, const Path& file) {
  Json json{{"schema", kSchema}, {"recent", Json::array()}, {"folders", Json::object()}};
  for (const Recent& recent : recent_files.recents)
    json["recent"].push_back({{"path", recent.path.string()}, {"time", recent.time}});
  for (const auto& [purpose, folder] : recent_files.folders) json["folders"][purpose] = folder.string();
  json["recent_folders"] = Json::array();
  for (const Path& folder : recent_files.recent_folders) json["recent_folders"].push_back(folder.string());
  json["show_start"] = recent_files.show_start;
  json["hidden_files"] = recent_files.hidden_files;
  json["tour_step"] = recent_files.tour_step;
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  write_file_atomically(file, json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace limber::editor
