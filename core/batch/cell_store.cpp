// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/batch/cell_store.h"

#include <algorithm>
#include <array>
#include <optional>

#include <nlohmann/json.hpp>

#include "core/base/deflate.h"
#include "core/base/error.h"
#include "core/base/json_text.h"
#include "core/batch/computing_sources.h"
#include "core/batch/machine.h"
#include "core/platform/process.h"
#include "core/project/worker.h"
#include "core/report/report.h"

namespace limber {

namespace fs = std::filesystem;

namespace {
using Json = nlohmann::ordered_json;

constexpr int kHashLetters = 12;
constexpr std::size_t kLongestName = 60;

void make_folder(const Path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw Error("the folder cannot be made", folder.string(), error.message());
}

std::string text_of(const Json& json) { return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n"; }

std::string hash_of(const Json& json) {
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  return sha256_of_bytes(text.data(), text.size());
}

// Returns the extension of the file to which a copy of the volume `path` is written. It is the extension of `path` if
// this format can be written, else .nrrd.
std::string volume_ending(const Path& path) {
  const std::string name = path.filename().string();
  for (const char* ending : {".seg.nrrd", ".nrrd", ".mha", ".nii.gz", ".nii"})
    if (name.ends_with(ending)) return ending;
  return ".nrrd";
}

std::string labels_text(const std::vector<double>& labels) {
  std::string text;
  for (const double label : labels) text += (text.empty() ? "" : ",") + Json(label).dump();
  return text;
}

Json read_facts(const Path& file) { return Json::parse(sound_json(read_file(file)), nullptr, false); }

// Returns the SHA-256 of a file, or for a packed NRRD file that of its unpacked content, because the packer does not
// promise the same bytes for the same content.
std::string content_hash(const Path& file) {
  std::string bytes = read_file(file);
  const std::size_t header = bytes.find("\n\n");
  if (file.extension() == ".nrrd" && header != std::string::npos && bytes.find("encoding: gzip") < header) {
    std::string_view packed = std::string_view(bytes).substr(header + 2);
    std::string content = bytes.substr(0, header), piece(1 << 20, '\0');
    Inflater inflater;
    for (Inflater::Step step{.made = 1}; step.made > 0 && !step.damaged;) {
      step = inflater.inflate(packed, piece.data(), piece.size());
      packed.remove_prefix(step.taken);
      content.append(piece, 0, step.made);
    }
    if (!inflater.ended()) throw Error("the file is damaged", file.string(), "run the same command again");
    bytes = std::move(content);
  }
  return sha256_of_bytes(bytes.data(), bytes.size());
}

// Returns the hash of each file that a job has written into its folder, by file name. Times and memory in the report
// are not hashed.
std::map<std::string, std::string> hashes_of(const WorkFolder& into,
                                             const std::map<std::string, std::string>& outputs) {
  std::map<std::string, std::string> hashes;
  for (const auto& [option, file] : outputs) {
    if (option != "report") {
      hashes[file] = content_hash(into / file);
      continue;
    }
    Json report = read_facts(into / file);
    for (const char* key : {"seconds", "peak_memory_mb"}) report.erase(key);
    hashes[file] = hash_of(report);
  }
  return hashes;
}

// Returns the name of the first file whose hash is not the expected one; "" if all are.
std::string other_file(const std::map<std::string, std::string>& hashes,
                       const std::map<std::string, std::string>& expected) {
  for (const auto& [file, hash] : hashes)
    if (expected.at(file) != hash) return file;
  return "";
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

// Returns true if the folder contains a complete result whose cell.json states this key. The key is the hash of
// everything that the result depends on.
bool is_done(const Path& folder, const std::string& key) {
  if (!fs::exists(folder / "cell.json")) return false;
  const Json json = read_facts(folder / "cell.json");
  if (!json.is_object() || json.value("key", "") != key) return false;
  // An export lists no files in cell.json, since some formats write one file for each tissue.
  return !json.contains("files") || std::all_of(json["files"].begin(), json["files"].end(), [&](const Json& name) {
    std::error_code unreadable;
    return name.is_string() && fs::exists(folder / name.get<std::string>(), unreadable);
  });
}

StoredCell found(const Path& folder, const std::string& key) {
  return {is_done(folder, key) ? CellState::WasThere : CellState::Missing, folder, key, {}};
}
}  // namespace

// The inputs and bodies of a store's cells that this program has used so far.
struct CellStore::Parts {
  struct Body {
    std::string name, key;  // the folder's name, and the hash of everything that the body depends on
    std::string failure;    // why volume or weights could not be computed; empty: not tried, or computed
  };

  Path folder;
  int threads = 0;
  std::map<Path, Input> inputs;
  std::map<Path, std::string> hashes;
  std::map<const DescribedBody*, Body> bodies;

  const std::string& hash_of_file(const Path& file) {
    const auto [at, is_new] = hashes.try_emplace(file);
    if (is_new) at->second = sha256_of_file(file);
    return at->second;
  }

  const Input& take(const Path& file) {
    const auto [at, is_new] = inputs.try_emplace(file);
    if (!is_new || file.empty()) return at->second;
    Input input{fs::absolute(file), hash_of_file(file)};
    if (file.extension() != ".gltf") {
      const std::string name =
          file_word(file.stem().string()) + "-" + input.sha256.substr(0, kHashLetters) + file.extension().string();
      if (const Path copy = folder / "inputs" / name; !fs::exists(copy)) write_file_atomically(copy, read_file(file));
      input.path = Path("../../inputs") / name;
    }
    return at->second = input;
  }

  Body& body(const DescribedBody& described) {
    const auto [at, is_new] = bodies.try_emplace(&described);
    if (!is_new) return at->second;
    Json json{{"sources", computing_sources()},
              {"made", "body/1"},
              {"spacing_mm", described.spacing ? Json(*described.spacing) : Json()},
              {"weights", described.weights_file.empty() ? described.weights : take(described.weights_file).sha256}};
    if (described.no_seams) json["seams"] = "none";
    if (!described.seams.empty()) json["seams"] = take(described.seams).sha256;
    if (!described.phantom.empty()) {
      json["phantom"] = described.phantom;
    } else {
      json["volume"] = hash_of_file(described.volume);
      json["rig"] = take(described.rig).sha256;
      json["tissues"] = take(described.tissues).sha256;
      json["bone_map"] = take(described.bone_map).sha256;
      json["bones"] = described.bones;
    }
    at->second.key = hash_of(json);
    at->second.name = file_word(described.name) + "-" + at->second.key.substr(0, kHashLetters);
    return at->second;
  }

  // Adds the options of a job that name the body's files. `where` is the path of the body's folder from the job's
  // folder.
  void add_body_options(Json& job, const DescribedBody& body, const Path& where) {
    const bool is_phantom = !body.phantom.empty();
    job["volume"] = (where / ("volume" + (is_phantom ? ".nrrd" : volume_ending(body.volume)))).string();
    job["rig"] = is_phantom ? (where / "rig.json").string() : take(body.rig).path.string();
    if (is_phantom) job["tissues"] = (where / "tissues.json").string();
    if (!body.tissues.empty()) job["tissues"] = take(body.tissues).path.string();
    if (!body.bone_map.empty()) job["bone-map"] = take(body.bone_map).path.string();
    if (!body.bones.empty()) job["bones"] = labels_text(body.bones);
  }

  WorkerOutput work(const WorkFolder& into, const std::string& name, Json job, Progress& progress) const {
    write_file_atomically(into / name, text_of(job));
    if (threads == 0) return run_worker(into / name, progress);
    // The worker gets a second job file with the number of threads. The job file that stays with the result does not
    // contain this number, since results do not depend on it.
    job["threads"] = threads;
    write_file_atomically(into / "limited.json", text_of(job));
    WorkerOutput output = run_worker(into / "limited.json", progress);
    fs::remove(into / "limited.json");
    return output;
  }

  // Runs `work` in the working folder. Returns the reason if `work` fails, "" if it succeeds or if another program has
  // made the folder `place` meanwhile. Throws Error if the disk is full.
  std::string failure_of(const WorkFolder& into, const Path& place, const std::function<void()>& work) const {
    try {
      work();
    } catch (const Error& error) {
      if (fs::exists(place)) return {};  // another program has made the folder in the meantime
      if (!into.has_room())
        throw Error("the results cannot be written", folder.string(),
                    "free some space on the disk, then run the same command again");
      return error.what();
    }
    return {};
  }

  void make_body(WorkFolder& into, const DescribedBody& body, Progress& progress) {
    const double before = children_cpu_seconds();
    const bool is_phantom = !body.phantom.empty();
    Json first;
    if (is_phantom) first = {{"command", "phantom"}, {"subject", body.phantom}, {"output", "."}};
    else
      first = {{"command", "prepare"},
               {"volume", fs::absolute(body.volume).string()},
               {"output", "volume" + volume_ending(body.volume)}};
    if (body.spacing) first["spacing"] = *body.spacing;
    work(into, "volume-job.json", first, progress);
    const double made = children_cpu_seconds();
    if (body.weights_file.empty()) {
      Json job{{"command", "weights"}, {"method", body.weights}, {"output", "weights.nrrd"}};
      add_body_options(job, body, "");
      if (body.no_seams) job["seams"] = "none";
      if (!body.seams.empty()) job["seams"] = take(body.seams).path.string();
      work(into, "weights-job.json", job, progress);
    }
    write_file_atomically(
        into / "body.json",
        text_of({{"cpu_seconds", {{"volume", made - before}, {"weights", children_cpu_seconds() - made}}}}));
    into.commit();
  }

  // Makes the body's folder unless it exists. Returns false if another program is making it. A body that failed is not
  // tried again for its other cells.
  bool provide_body(const DescribedBody& described, IfBusy if_busy, Progress& progress) {
    Body& mine = body(described);
    const Path place = folder / "bodies" / mine.name;
    if (!mine.failure.empty() || fs::exists(place)) return true;
    WorkFolder into(place, progress, if_busy);
    if (into.busy()) return false;
    if (!into.made()) mine.failure = failure_of(into, place, [&] { make_body(into, described, progress); });
    return true;
  }

  Json job_of(const CellRequest& request) {
    const auto& [body, pose, technique, settings, name, facts] = request;
    const Path where = Path("../../bodies") / this->body(body).name;
    Json job{{"command", "resample"}};
    add_body_options(job, body, where);
    job["weights"] =
        body.weights_file.empty() ? (where / "weights.nrrd").string() : take(body.weights_file).path.string();
    if (!pose.flex.empty()) job["flex"] = pose.flex;
    if (!pose.body.name.empty()) job["pose_name"] = pose.body.name;
    if (!pose.body.joints.empty()) job["joints"] = pose.body.joints;
    for (const auto& [key, file] : {std::pair{"pose", &pose.pose}, {"motion", &pose.motion}, {"map", &pose.map}})
      if (!file->empty()) job[key] = take(*file).path.string();
    if (pose.frame) job["frame"] = *pose.frame;
    if (!pose.up.empty()) job["up"] = pose.up;
    job["method"] = technique.method;
    if (technique.contact) job["contact"] = true;
    if (technique.is_fem()) job["quality"] = settings.quality;
    if (technique.mass_exact) job["mass-exact"] = true;
    if (settings.fit_joints) job["fit-joints"] = true;
    if (settings.nearest) job["nearest"] = true;
    if (!settings.glide.empty()) job["glide"] = settings.glide;
    for (const auto& [option, file] : settings.outputs) job[option] = file;
    if (technique.is_fem() && !pose.is_rest() && !settings.mesh.empty()) job["mesh-out"] = settings.mesh;
    if (!body.grey.empty()) job["with"] = take(body.grey).path.string() + "=grey" + volume_ending(body.grey);
    if (!body.landmarks.empty()) job["landmarks"] = take(body.landmarks).path.string() + "=landmarks.csv";
    return job;
  }

  std::string key_of(const CellRequest& request, const Json& job) {
    const DescribedPose& pose = request.pose;
    Json json{{"sources", computing_sources()},
              {"made", "cell/1"},
              {"body", body(request.body).key},
              {"job", job},
              {"inputs",
               {take(pose.pose).sha256, take(pose.motion).sha256, take(pose.map).sha256, take(request.body.grey).sha256,
                take(request.body.landmarks).sha256}}};
    if (request.settings.repeats > 1) json["repeats"] = request.settings.repeats;
    return hash_of(json);
  }

  // Computes a cell in its working folder and then renames that folder to the cell's folder.
  void make_cell(WorkFolder& into, const CellRequest& request, const Json& job, const std::string& key,
                 const std::function<void(const WorkFolder&)>& finish, Progress& progress) const {
    std::vector<double> cpu, wall;
    bool reached = false;
    std::map<std::string, std::string> first;
    for (int run = 1; run <= request.settings.repeats; ++run) {
      const Stopwatch watch;
      const double before = children_cpu_seconds();
      reached = work(into, "job.json", job, progress).pose_reached;
      cpu.push_back(children_cpu_seconds() - before);
      wall.push_back(watch.seconds());
      if (request.settings.repeats == 1) break;
      const auto hashes = hashes_of(into, request.settings.outputs);
      if (run == 1) first = hashes;
      if (const std::string other = other_file(hashes, first); !other.empty())
        throw Error("repeat " + std::to_string(run) + " gave another " + other + " than the first", request.name,
                    "use neither result: results must not differ from run to run, so this is an error of Limber or of "
                    "the machine");
    }
    if (finish) finish(into);
    Json facts{{"schema", "limber-cell/1"}, {"key", key}};
    facts.update(Json::parse(request.facts));
    facts.update({{"pose_reached", reached},
                  {"cpu_seconds", median(cpu)},
                  {"wall_seconds", median(wall)},
                  {"machine", machine_text()},
                  {"sources", computing_sources()},
                  {"files", {"report.json", request.settings.outputs.at("output")}}});
    if (request.settings.repeats > 1) facts["repeats"] = {{"cpu_seconds", cpu}, {"wall_seconds", wall}};
    write_file_atomically(into / "cell.json", text_of(facts));
    into.commit();
  }
};

CellStore::CellStore(const Path& folder, int threads) : folder_(folder), parts_(std::make_unique<Parts>()) {
  parts_->folder = folder;
  parts_->threads = threads;
  make_folder(folder);
  for (const char* name : {"inputs", "bodies", "cells", "exports"}) make_folder(folder / name);
}
CellStore::~CellStore() = default;

const CellStore::Input& CellStore::take(const Path& file) { return parts_->take(file); }

StoredCell CellStore::find(const CellRequest& request) {
  const std::string key = parts_->key_of(request, parts_->job_of(request));
  return found(folder_ / "cells" / (request.name + "-" + key.substr(0, kHashLetters)), key);
}

StoredCell CellStore::compute(const CellRequest& request, IfBusy if_busy, Progress& progress,
                              const std::function<void(const WorkFolder&)>& finish) {
  StoredCell cell = find(request);
  if (cell.state == CellState::WasThere) return cell;
  if (!parts_->provide_body(request.body, if_busy, progress)) {
    cell.state = CellState::Busy;
    return cell;
  }
  cell.failure = parts_->body(request.body).failure;
  if (cell.failure.empty()) {
    if (fs::exists(cell.folder)) fs::remove_all(cell.folder);  // the result in the folder is damaged
    WorkFolder into(cell.folder, progress, if_busy);
    cell.state = into.made() ? CellState::WasThere : into.busy() ? CellState::Busy : CellState::Made;
    if (cell.state == CellState::Made)
      cell.failure = parts_->failure_of(into, cell.folder, [&] {
        parts_->make_cell(into, request, parts_->job_of(request), cell.key, finish, progress);
      });
  }
  if (!cell.failure.empty()) cell.state = CellState::Failed;
  return cell;
}

StoredCell CellStore::find_export(const StoredCell& cell, const std::string& name, const std::string& job) const {
  const std::string key =
      hash_of({{"made", "export/1"}, {"version", LIMBER_VERSION}, {"cell", cell.key}, {"job", job}});
  return found(folder_ / "exports" / (name + "-" + key.substr(0, kHashLetters)), key);
}

StoredCell CellStore::compute_export(const StoredCell& cell, const std::string& name, const std::string& job,
                                     IfBusy if_busy, Progress& progress) const {
  StoredCell made = find_export(cell, name, job);
  if (made.state == CellState::WasThere) return made;
  if (fs::exists(made.folder)) fs::remove_all(made.folder);
  WorkFolder into(made.folder, progress, if_busy);
  made.state = into.made() ? CellState::WasThere : into.busy() ? CellState::Busy : CellState::Made;
  if (made.state != CellState::Made) return made;
  made.failure = parts_->failure_of(into, made.folder, [&] {
    parts_->work(into, "job.json", Json::parse(job), progress);
    write_file_atomically(into / "cell.json", text_of({{"schema", "limber-cell/1"}, {"key", made.key}}));
    into.commit();
  });
  if (!made.failure.empty()) made.state = CellState::Failed;
  return made;
}

double wall_seconds_of(const Path& cell_folder) {
  const Json json = read_facts(cell_folder / "cell.json");
  return json.is_object() ? json.value("wall_seconds", 0.0) : 0;
}

std::string file_word(const std::string& text) {
  std::string result;
  for (const char c : text)
    if (std::isalnum(static_cast<unsigned char>(c)) || c == '+' || c == '-' || c == '.' || c == '_') result += c;
  return result.substr(0, kLongestName);
}

}  // namespace limber
