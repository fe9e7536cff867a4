// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/cmd/slicer_xml.h"

#include <algorithm>
#include <cctype>
#include <map>

#include "core/cmd/command_files.h"

namespace limber::cmd {

namespace {

// The XML element that describes an option to Slicer: its name and its attributes, such as the endings of files to
// select.
struct Element {
  std::string name, attributes;
};
const Element kLabels{"image", R"( type="label")"}, kScalars{"image", ""}, kField{"image", R"( type="vector")"};

Element file_of(const std::string& endings) { return {"file", R"( fileExtensions=")" + endings + '"'}; }

// inputs() and outputs() return the XML elements of the options that name volumes or files, by the option's name. Every
// other output is described as a file, every other input as a text.
const std::map<std::string, Element>& inputs() {
  static const std::map<std::string, Element> kInputs = {
      {"VOLUME", kLabels},
      {"IN", kLabels},
      {"BEFORE", kLabels},
      {"AFTER", kLabels},
      {"FILE", file_of("*")},
      {"BATCH", file_of(".json")},
      {"STUDY", file_of(".json")},
      {"JOB", file_of(".json")},
      {"CASE", file_of(".json")},
      {"RIG", file_of(".json,.vtk,.arm,.bvh,.gltf,.glb")},
      {"--rig", file_of(".json,.vtk,.arm,.bvh,.gltf,.glb")},
      {"--tissues", file_of(".json,.ctbl,.txt")},
      {"--weights", file_of(".nrrd")},
      {"--motion", file_of(".bvh")},
      {"--pose", file_of(".json")},
      {"--map", file_of(".json")},
      {"--bone-map", file_of(".json")},
      {"--properties", file_of(".csv")},
      {"--play", file_of(".txt")},
      {"--baked", file_of(".bake")},
  };
  return kInputs;
}
const std::map<std::string, Element>& outputs() {
  static const std::map<std::string, Element> kOutputs = {
      {"resample --output", kLabels},
      {"prepare --output", kLabels},
      {"convert OUT", file_of("*")},
      {"weights --output", file_of(".nrrd")},
      {"repair-joint --output", file_of(".nrrd")},
      {"bake-joint --output", file_of(".bake")},
      {"clean-motion --output", file_of(".bvh")},
      {"fit-rig --output", file_of(".json")},
      {"fit-joint --output", file_of(".json")},
      {"phantom --output", {"directory", ""}},
      {"batch --output", {"directory", ""}},
      {"experiment --output", {"directory", ""}},
      {"guide --html", {"directory", ""}},
      {"weights --bender-dir", {"directory", ""}},
      {"resample --field", kField},
      {"resample --jacobian", kScalars},
      {"resample --overlap", kLabels},
      {"resample --report", file_of(".json")},
  };
  return kOutputs;
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      case '\n': out += ' '; break;
      default: out += c;
    }
  return out;
}

std::string line(int indent, const std::string& tag, const std::string& text) {
  return std::string(static_cast<std::size_t>(2 * indent), ' ') + "<" + tag + ">" + escaped(text) + "</" + tag + ">\n";
}

// Makes a title of an option's name: "fit-joints" becomes "Fit joints".
std::string title_of(std::string words) {
  std::replace(words.begin(), words.end(), '-', ' ');
  if (!words.empty()) words[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(words[0])));
  return words;
}

bool is_positional(const CLI::Option& option) { return option.get_lnames().empty() && option.get_snames().empty(); }

// Returns the option's name in the form of the keys of inputs(), such as "--rig" or "VOLUME".
std::string name_of(const CLI::Option& option) {
  if (!option.get_lnames().empty()) return "--" + option.get_lnames().front();
  if (!option.get_snames().empty()) return "-" + option.get_snames().front();
  return option.get_name(true);
}

// Returns the words that are allowed as the option's value; empty if any value is allowed. CLI11 describes them as
// "{heat,geodesic,rigid}".
std::vector<std::string> words_of(CLI::Option& option) {
  for (int at = 0;; ++at) {
    const CLI::Validator* validator = nullptr;
    try {
      validator = option.get_validator(at);
    } catch (const CLI::OptionNotFound&) {
      return {};
    }
    const std::string described = validator->get_description();
    if (described.size() < 3 || described.front() != '{' || described.back() != '}') continue;
    return CLI::detail::split(described.substr(1, described.size() - 2), ',');
  }
}

// Slicer passes every choice and every number that its form shows, even one that the user has not set. Numbers, and
// choices without a default, are therefore described as texts: Slicer omits an empty text.
Element element_of(CLI::Option& option, const std::string& command) {
  const std::string name = name_of(option);
  if (option.get_expected_max() == 0) return {"boolean", ""};
  if (const auto output = outputs().find(command + " " + name); output != outputs().end()) return output->second;
  const bool is_pair = option.get_type_name().find('=') != std::string::npos;  // true for values of the form IN=OUT
  if (names_outputs(option)) return is_pair ? Element{"string", ""} : file_of("*");
  if (const auto input = inputs().find(name); input != inputs().end()) return input->second;
  if (option.get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll) return {"string", R"( multiple="true")"};
  const bool is_choice = !option.get_default_str().empty() && !words_of(option).empty();
  return {is_choice ? "string-enumeration" : "string", ""};
}

std::string described(CLI::Option& option, const std::string& command, int index) {
  const Element element = element_of(option, command);
  const std::string name = name_of(option);
  std::string bare = name.substr(name.find_first_not_of('-')), identifier = bare;
  std::transform(identifier.begin(), identifier.end(), identifier.begin(),
                 [](unsigned char c) { return std::isalnum(c) ? static_cast<char>(c) : '_'; });
  std::string text = "    <" + element.name + element.attributes + ">\n" + line(3, "name", identifier);
  if (is_positional(option)) {
    text += line(3, "index", std::to_string(index));
  } else {
    if (!option.get_snames().empty()) text += line(3, "flag", "-" + option.get_snames().front());
    if (!option.get_lnames().empty()) text += line(3, "longflag", "--" + option.get_lnames().front());
  }
  std::string words;
  for (const std::string& word : words_of(option)) words += (words.empty() ? "" : ", ") + word;
  const bool is_choice = element.name == "string-enumeration";
  text += line(3, "description", option.get_description() + (words.empty() || is_choice ? "" : " (" + words + ")"));
  std::transform(bare.begin(), bare.end(), bare.begin(), [](unsigned char c) { return std::tolower(c); });
  text += line(3, "label", title_of(bare));
  if (element.name == "boolean") text += line(3, "default", "false");
  else if (!option.get_default_str().empty()) text += line(3, "default", option.get_default_str());
  if (element.name == "image" || element.name == "file" || element.name == "directory")
    text += line(3, "channel", names_outputs(option) ? "output" : "input");
  if (is_choice)
    for (const std::string& word : words_of(option)) text += line(3, "element", word);
  return text + "    </" + element.name + ">\n";
}

}  // namespace

std::string slicer_xml(CLI::App& command, const std::string& name) {
  std::string text = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<executable>\n";
  text += line(1, "category", "Limber") + line(1, "title", "Limber: " + title_of(name));
  text += line(1, "description", command.get_description()) + line(1, "version", LIMBER_VERSION);
  text += line(1, "documentation-url", "") + line(1, "license", "AGPL-3.0-or-later");
  text += line(1, "contributor", "The authors of Limber");
  const auto is_shown = [&](const CLI::Option* option) {
    return !option->get_group().empty() && option != command.get_help_ptr() && option != command.get_help_all_ptr();
  };
  // Lists the required parameters first, then one group after the other.
  constexpr const char* kNeeded = "Input and output";
  std::vector<std::string> groups{kNeeded};
  std::map<std::string, std::string> parameters;
  int index = 0;
  for (CLI::Option* option : command.get_options()) {
    if (!is_shown(option)) continue;
    const bool is_needed = option->get_required() || is_positional(*option);
    const std::string group = is_needed ? kNeeded : option->get_group();
    if (std::find(groups.begin(), groups.end(), group) == groups.end()) groups.push_back(group);
    parameters[group] += described(*option, name, index);
    index += is_positional(*option);
  }
  for (const std::string& group : groups) {
    if (parameters[group].empty()) continue;
    text += group == kNeeded ? "  <parameters>\n" : "  <parameters advanced=\"true\">\n";
    text += line(2, "label", group) + line(2, "description", group == kNeeded ? "Files to read and to write" : group);
    text += parameters[group] + "  </parameters>\n";
  }
  return text + "</executable>\n";
}

std::string requested_slicer_xml(CLI::App& app, const std::vector<std::string>& words) {
  if (words.size() != 2 || words.back() != "--xml") return "";
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; }))
    if (command->get_name() == words.front()) return slicer_xml(*command, words.front());
  return "";
}

}  // namespace limber::cmd
