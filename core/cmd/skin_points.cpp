// SPDX-License-Identifier: AGPL-3.0-or-later
// limber skin-points CASE.json --method lbs|dqs|mix [--json]
// Poses the points of a skin-ref/1 test case by skinning, to compare the result with other programs. A case contains:
//   bones[]{rest[16], pose[16]}      row-major 4x4, world from bone, at rest and posed
//   rest[]                           x y z of each point
//   influence_offsets[] influence_bones[] influence_weights[]
//                                    point i has the influences offsets[i] .. offsets[i + 1] - 1
#include <cmath>
#include <memory>

#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/cmd/command.h"
#include "core/deform/skinning.h"
#include "core/resample/deformation_method.h"

namespace limber::cmd {

namespace {

struct SkinCase {
  std::vector<SkinTransform> bones;
  std::vector<BoneWeight> influences;
  std::vector<std::int64_t> offsets;
  std::vector<glm::dvec3> points;
};

class CaseReader {
 public:
  explicit CaseReader(const Path& path) : where_(path.string()) {
    json_ = nlohmann::json::parse(checked_json(read_file(path), where_), nullptr, false);
    if (!json_.is_object()) fail("this is not a JSON object", "give a file of schema skin-ref/1");
    if (json_.value("schema", nlohmann::json()) != "skin-ref/1")
      fail("\"schema\" is not \"skin-ref/1\"", "give a file of that schema");
  }

  SkinCase read() const {
    SkinCase skin;
    for (const auto& bone : array(json_, "bones")) {
      const glm::dmat4 rest = matrix(bone, "rest"), pose = matrix(bone, "pose");
      const glm::dmat4 bone_from_world = glm::inverse(rest);
      if (!std::isfinite(bone_from_world[0][0]) || glm::determinant(rest) == 0)
        fail("a bone's \"rest\" matrix cannot be inverted", "correct the matrix");
      skin.bones.push_back(skin_transform(pose * bone_from_world, rest));
    }
    const auto flat = numbers(json_, "rest");
    if (flat.size() % 3 != 0) fail("\"rest\" is not a list of x, y, z numbers", "give three numbers for each point");
    for (size_t i = 0; i < flat.size(); i += 3) skin.points.emplace_back(flat[i], flat[i + 1], flat[i + 2]);
    read_influences(skin);
    return skin;
  }

 private:
  [[noreturn]] void fail(const std::string& what, const std::string& what_to_do) const {
    throw Error(what, where_, what_to_do);
  }

  const nlohmann::json& array(const nlohmann::json& object, const char* key) const {
    if (!object.is_object() || !object.contains(key) || !object[key].is_array())
      fail("the list \"" + std::string(key) + "\" is missing", "add it");
    return object[key];
  }

  std::vector<double> numbers(const nlohmann::json& object, const char* key) const {
    std::vector<double> values;
    for (const auto& value : array(object, key)) {
      if (!value.is_number() || !std::isfinite(value.get<double>()))
        fail("\"" + std::string(key) + "\" contains a value that is not a finite number", "correct the list");
      values.push_back(value.get<double>());
    }
    return values;
  }

  // Reads a 4x4 matrix, which the file stores row by row.
  glm::dmat4 matrix(const nlohmann::json& object, const char* key) const {
    const auto values = numbers(object, key);
    if (values.size() != 16) fail("\"" + std::string(key) + "\" of a bone is not 16 numbers", "give a 4x4 matrix");
    glm::dmat4 m;
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column) m[column][row] = values[4 * row + column];
    return m;
  }

  void read_influences(SkinCase& skin) const {
    const auto offsets = numbers(json_, "influence_offsets"), bones = numbers(json_, "influence_bones"),
               weights = numbers(json_, "influence_weights");
    if (bones.size() != weights.size())
      fail("\"influence_bones\" and \"influence_weights\" differ in length", "correct the lists");
    if (offsets.size() != skin.points.size() + 1)
      fail("\"influence_offsets\" must have exactly one number more than there are points", "correct the list");
    for (size_t i = 0; i < bones.size(); ++i) {
      if (!(bones[i] >= 0 && bones[i] < double(skin.bones.size())) || !(weights[i] >= 0))
        fail("influence " + std::to_string(i) + " has an unknown bone or a negative weight", "correct the influence");
      skin.influences.push_back({static_cast<int>(bones[i]), weights[i]});
    }
    double last = 0;
    for (double offset : offsets) {
      if (!(offset >= last && offset <= double(bones.size())))
        fail("the numbers of \"influence_offsets\" do not ascend, or exceed the number of influences",
             "correct the list");
      skin.offsets.push_back(static_cast<std::int64_t>(offset));
      last = offset;
    }
  }

  std::string where_;
  nlohmann::json json_;
};

void print_points(const std::vector<glm::dvec3>& points, bool as_json) {
  if (!as_json) {
    for (const auto& p : points) print("%.9g %.9g %.9g\n", p.x, p.y, p.z);
    return;
  }
  nlohmann::json flat = nlohmann::json::array();
  for (const auto& p : points)
    for (int axis = 0; axis < 3; ++axis) flat.push_back(p[axis]);
  print_json(nlohmann::json{{"points", std::move(flat)}}.dump() + "\n");
}

}  // namespace

void add_skin_points(CLI::App& app) {
  struct Options {
    std::string file, method;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  auto* command = app.add_subcommand(
      "skin-points",
      "poses the points of a test case of skinning (JSON, schema skin-ref/1) by blending, and prints them");
  command->add_option("CASE", options->file, "test case: JSON file of schema skin-ref/1")->required();
  command->add_option("--method", options->method, method_summaries(Methods::Blends))
      ->required()
      ->check(CLI::IsMember(method_words(Methods::Blends)));
  command->add_flag("--json", options->json, "print {\"points\": [x, y, z, ...]}");
  command->callback([options] {
    SkinCase skin = CaseReader(options->file).read();
    const Blend blend = *find_blend(options->method);
    blend_points(blend, skin.bones, skin.influences, skin.offsets, skin.points, skin.points);
    print_points(skin.points, options->json);
  });
}

}  // namespace limber::cmd
