// SPDX-License-Identifier: AGPL-3.0-or-later
// limber job JOB.json: runs a command that is described in a file, as workers and cluster nodes do. The keys of the
// JSON object are the command's options, so a job does exactly what the command line does. Jobs can run "resample" and
// the commands around it: "prepare", "weights", "convert", and "phantom" (with "subject" instead of "volume").
//   {"command": "resample", "volume": "arm.mha", "rig": "rig.json", "flex": ["Forearm=90"], "method": "dqs",
//    "output": "posed.nrrd"}
//   {..., "pose_name": "sit", "joints": ["left elbow flexion=30"], ...}
// A list of values repeats its option; bones and labels are one text, joined by commas. The value true sets a flag, and
// "_" may replace "-" in a key. Paths are relative to the job's folder.
#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/cmd/command.h"
#include "core/cmd/command_files.h"
#include "core/project/worker.h"

namespace limber::cmd {

namespace {

using Json = nlohmann::json;

struct JobCommand {
  void (*add)(CLI::App&) = nullptr;
  std::vector<std::string> places = {"volume"};  // keys whose values are positional arguments, in their order
};
const std::map<std::string, JobCommand> kCommands = {{"convert", {add_convert, {"volume", "output"}}},
                                                     {"phantom", {add_phantom, {"subject"}}},
                                                     {"prepare", {add_prepare}},
                                                     {"resample", {add_resample}},
                                                     {"weights", {add_weights}}};
constexpr std::uint64_t kLargestJob = 1 << 20;

std::string text_of(const Json& value, const std::string& key, const Path& job) {
  if (value.is_string()) {
    const std::string text = value.get<std::string>();
    if (text.find('\0') != std::string::npos)
      throw Error("a setting contains a zero byte", job.string() + ", " + key, "remove the byte");
    return text;
  }
  if (value.is_number()) return value.dump();
  throw Error("a setting is neither text nor a number", job.string() + ", " + key, "write \"" + key + "\": \"value\"");
}

const std::vector<std::string>& places_of(const Json& job) {
  return kCommands.at(job.at("command").get<std::string>()).places;
}

// Returns the command-line option for a key of the job. Keys may also be spelled as in reports: "pose_name" for
// --pose-name, "joints" for --joint, "obstacles" for --obstacle.
std::string option_of(std::string key) {
  std::replace(key.begin(), key.end(), '_', '-');
  if (key == "joints" || key == "obstacles") key.pop_back();  // keys with lists are plural, the option is singular
  return "--" + key;
}

// Returns the words of the command line that is equivalent to the job.
std::vector<std::string> words_of(const Json& job, const Path& path) {
  std::vector<std::string> words{job.at("command").get<std::string>()};
  const std::vector<std::string>& places = places_of(job);
  for (const std::string& key : places) words.push_back(text_of(job.at(key), key, path));
  for (const auto& [key, value] : job.items()) {
    if (key == "command" || std::find(places.begin(), places.end(), key) != places.end()) continue;
    if (value.is_boolean()) {
      if (value.get<bool>()) words.push_back(option_of(key));
    } else if (value.is_array()) {
      for (const Json& one : value) words.push_back(option_of(key) + "=" + text_of(one, key, path));
    } else {
      words.push_back(option_of(key) + "=" + text_of(value, key, path));
    }
  }
  return words;
}

Json read_job(const Path& path) {
  const Json job = Json::parse(checked_json(read_file(path, kLargestJob), path.string()), nullptr, false);
  if (!job.is_object())
    throw Error("this is not a job", path.string(), "write a JSON object with \"command\" and its options");
  const auto require = [&](const std::string& key) {
    if (!job.contains(key) || !job[key].is_string())
      throw Error("the job has no \"" + key + "\"", path.string(),
                  "add it: \"command\": \"resample\", \"volume\": FILE");
  };
  require("command");
  if (!kCommands.contains(job["command"].get<std::string>()))
    throw Error("a job cannot run this command", path.string() + ", " + job["command"].get<std::string>(),
                "use \"command\": \"resample\"");
  for (const std::string& key : places_of(job)) require(key);
  return job;
}

struct JobOptions {
  std::string file;
  std::string progress;
  int memory_limit = 0, parent = 0;
  bool yields = false;
};

void run_job(const JobOptions& options) {
  become_worker(options.memory_limit, options.yields, options.parent);
  std::optional<Heartbeat> heartbeat;  // empty without a parent process that would read the heartbeat
  if (options.parent > 0) heartbeat.emplace();
  const Path path = options.file;
  Json job = read_job(path);
  if (!options.progress.empty()) job["progress"] = options.progress;
  std::vector<std::string> words = words_of(job, path);
  const Path where = std::filesystem::absolute(path);
  std::filesystem::current_path(where.parent_path());

  CLI::App app;
  kCommands.at(words.front()).add(app);
  CLI::App* command = app.get_subcommand(words.front());
  command->parse_complete_callback([=] { check_files(*command, where); });
  std::reverse(words.begin(), words.end());  // CLI11 reads the words from the end of the list to its start
  try {
    app.parse(words);
  } catch (const CLI::ParseError& error) {
    throw Error("the options of the job do not fit its command", path.string(), error.what());
  }
}

}  // namespace

void add_job(CLI::App& app) {
  auto* command = app.add_subcommand("job", "runs a command that a file describes, such as resample");
  auto options = std::make_shared<JobOptions>();
  command
      ->add_option("JOB", options->file,
                   "job file (JSON): {\"command\": \"resample\", \"volume\": FILE, \"rig\": FILE, ...}, with the "
                   "command's options as keys")
      ->required();
  command
      ->add_option("--progress", options->progress,
                   "with the value json: print progress to stderr, one line of JSON per step (default: a progress bar)")
      ->check(CLI::IsMember({"json"}));
  command
      ->add_option("--memory-limit", options->memory_limit,
                   "stop the job if it needs more memory than this, MB (default: no limit)")
      ->check(CLI::Range(1, 1 << 30));
  command->add_flag("--yield", options->yields, "run at the lowest priority");
  command->add_option("--parent", options->parent,
                      "process ID of the program that started the job; the job stops when that program ends");
  command->callback([options] { run_job(*options); });
}

}  // namespace limber::cmd
