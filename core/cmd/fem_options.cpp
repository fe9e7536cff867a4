// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/cmd/fem_options.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/text_parse.h"
#include "core/cmd/command_files.h"
#include "core/mesh/surface_file.h"
#include "core/mesh/surface_shapes.h"
#include "core/tissue/tissue_match.h"

namespace limber::cmd {

namespace {

constexpr const char* kExample = "write it as phone.stl@-80,0,1500@from=-1,0,0 or box:450,400,40@0,0,700@force=20";

std::vector<std::string> parts_of(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator) parts.emplace_back();
    else parts.back() += c;
  }
  return parts;
}

// Returns the numbers of a list such as "1,2,3". Returns nothing if the text is no list with one of the given lengths.
std::optional<std::vector<double>> list_of(const std::string& text, std::initializer_list<std::size_t> lengths) {
  std::vector<double> numbers;
  for (const std::string& part : parts_of(text, ',')) {
    const std::optional<double> number = number_of<double>(part);
    if (!number || !std::isfinite(*number)) return std::nullopt;
    numbers.push_back(*number);
  }
  for (const std::size_t length : lengths)
    if (numbers.size() == length) return numbers;
  return std::nullopt;
}

[[noreturn]] void refuse(const std::string& what, const std::string& where) { throw Error(what, where, kExample); }

bool begins(const std::string& text, const std::string& with) { return text.compare(0, with.size(), with) == 0; }

TriangleMesh shape_of(const std::string& shape) {
  const auto sizes = [&](const char* word, std::size_t count) {
    const auto numbers = list_of(shape.substr(std::string(word).size()), {count});
    if (!numbers || std::any_of(numbers->begin(), numbers->end(), [](double size) { return !(size > 0); }))
      refuse(std::string(word) + " needs " + std::to_string(count) + " sizes above 0, in mm", "--obstacle " + shape);
    return *numbers;
  };
  if (begins(shape, "box:")) {
    const auto size = sizes("box:", 3);
    return box_surface({size[0], size[1], size[2]});
  }
  for (const char* word : {"cylinder:", "tube:"})
    if (begins(shape, word)) {
      const auto size = sizes(word, 2);
      return cylinder_surface(size[0], size[1], word[0] == 't' ? CylinderEnds::Open : CylinderEnds::Closed);
    }
  if (begins(shape, "plane:")) {
    const auto size = sizes("plane:", 2);
    return plane_surface(size[0], size[1]);
  }
  return read_surface(shape);
}

glm::dmat3 linear_of(const std::vector<double>& matrix) {
  glm::dmat3 linear;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) linear[column][row] = matrix[4 * row + column];
  return linear;
}

// Returns the unit vector with the direction of `v`; nothing for a zero vector.
std::optional<glm::dvec3> direction_of(const std::vector<double>& v) {
  const double largest = std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])});
  if (!(largest > 0)) return std::nullopt;
  return glm::normalize(glm::dvec3(v[0] / largest, v[1] / largest, v[2] / largest));
}

void put_at(const std::vector<double>& place, TriangleMesh& surface) {
  for (glm::dvec3& v : surface.V) {
    if (place.size() == 3) {
      v += glm::dvec3(place[0], place[1], place[2]);
      continue;
    }
    const glm::dvec3 p = v;
    for (int row = 0; row < 3; ++row)
      v[row] = place[4 * row] * p.x + place[4 * row + 1] * p.y + place[4 * row + 2] * p.z + place[4 * row + 3];
  }
}

FemObject object_of(const std::string& request) {
  const std::vector<std::string> parts = parts_of(request, '@');
  const std::string where = "--obstacle " + request;
  FemObject object;
  object.name = parts[0];
  object.surface = shape_of(parts[0]);
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const std::string& part = parts[i];
    if (part == "from=around") {
      object.tightens = true;
    } else if (begins(part, "from=")) {
      const auto from = list_of(part.substr(5), {3});
      if (from) object.from = direction_of(*from);
      if (!object.from) refuse("from= needs a direction, or \"around\"", where);
    } else if (part == "force=weight") {
      object.share_of_weight = 1;
    } else if (begins(part, "force=")) {
      const auto force = list_of(part.substr(6), {1});
      if (!force || !((*force)[0] > 0)) refuse("force= needs newtons above 0, or \"weight\"", where);
      object.force_n = (*force)[0];
    } else {
      const auto place = list_of(part, {3, 12});
      if (place && place->size() == 12 && std::abs(glm::determinant(linear_of(*place))) < 1e-9)
        refuse("the matrix is singular: it flattens the object", where);
      if (!place) refuse("\"" + part + "\" is not a position: write 3 or 12 numbers", where);
      put_at(*place, object.surface);
    }
  }
  if (object.surface.V.empty()) refuse("the object has no triangles", where);
  return object;
}

}  // namespace

void add_fem_options(CLI::App& command, const std::shared_ptr<FemOptions>& options) {
  command.add_flag("--contact", options->contact,
                   "with --method fem: let skin press against skin instead of passing through it");
  command.add_flag("--slide", options->slide,
                   "with --method fem: near bent joints skin and fat slide over the bone instead of sticking to it");
  command
      .add_option("--quality", options->quality,
                  "with --method fem: resolution of the mesh: 8 tets across the thinnest bent limb (draft), 12 "
                  "(normal), or 24 around joints (fine); tets of 12, 8 and 4 mm in an adult's elbow")
      ->check(CLI::IsMember({"draft", "normal", "fine"}));
  command.add_flag("--error-estimate", options->error_estimate,
                   "with --method fem: solve again with tets of 1.5 times the edge length, and estimate the error of "
                   "positions that is due to the size of the tets; takes about 40 % longer");
  command
      .add_option("--mesher", options->mesher,
                  "with --method fem: method that fills the body's surface with tets: lattice (default) or tetgen")
      ->check(CLI::IsMember({"lattice", "tetgen"}));
  command
      .add_option(
          "--obstacle", options->obstacles,
          "with --method fem, repeatable: a rigid object that is pressed against the posed body. SHAPE is a surface "
          "file (STL, OBJ, PLY, glTF), or in mm box:X,Y,Z, cylinder:RADIUS,LENGTH, tube:RADIUS,LENGTH or plane:X,Y, "
          "centred at the origin. @X,Y,Z moves the object to this position, @ and 12 numbers transform it by a 3 x 4 "
          "matrix, given row by row; @from=X,Y,Z is the direction from which it comes (default: the shortest way), "
          "@from=around tightens a cuff; @force=NEWTON or @force=weight moves the object until it presses with this "
          "force, or with the body's weight")
      ->type_name("SHAPE[@PLACE][@from=..][@force=..]");
  command
      .add_option("--gravity", options->gravity,
                  "with --method fem: direction of gravity; soft tissue sags under its weight")
      ->type_name("X,Y,Z");
  writes(command.add_option("--pressure", options->pressure,
                            "with --method fem: table to write: the pressure of obstacles on each node of the skin"))
      ->type_name("OUT.csv");
}

std::string given_fem_option(const FemOptions& options) {
  if (options.contact) return "--contact";
  if (options.slide) return "--slide";
  if (!options.quality.empty()) return "--quality";
  if (options.error_estimate) return "--error-estimate";
  if (!options.mesher.empty()) return "--mesher";
  if (!options.obstacles.empty()) return "--obstacle";
  if (!options.gravity.empty()) return "--gravity";
  return options.pressure.empty() ? "" : "--pressure";
}

std::vector<FemObject> objects_of(const FemOptions& options) {
  std::vector<FemObject> objects;
  for (const std::string& request : options.obstacles) {
    FemObject object = object_of(request);
    const auto alike = std::count_if(objects.begin(), objects.end(), [&](const FemObject& other) {
      return other.name == object.name || other.name.starts_with(object.name + " (");
    });
    if (alike) object.name += " (" + std::to_string(alike + 1) + ")";
    objects.push_back(std::move(object));
  }
  if (objects.empty() && !options.pressure.empty())
    throw Error("there is no pressure without an obstacle", "--pressure " + options.pressure, "give an --obstacle");
  return objects;
}

glm::dvec3 gravity_of(const FemOptions& options) {
  if (options.gravity.empty()) return glm::dvec3(0);
  const auto down = list_of(options.gravity, {3});
  const std::optional<glm::dvec3> direction = down ? direction_of(*down) : std::nullopt;
  if (!direction) throw Error("gravity needs a direction", "--gravity " + options.gravity, "write X,Y,Z, as in 0,0,-1");
  return kStandardGravity * *direction;
}

void write_pressure(const std::vector<PressedNode>& pressed, const std::vector<ObjectReport>& objects,
                    const Path& path) {
  std::string text = "object,x_mm,y_mm,z_mm,pressure_kpa,area_mm2\n";
  for (const PressedNode& node : pressed) {
    char row[160];
    std::snprintf(row, sizeof row, ",%.3f,%.3f,%.3f,%.5g,%.5g\n", node.position.x, node.position.y, node.position.z,
                  node.kpa, node.area_mm2);
    text += csv_field(objects[node.object].name) + row;
  }
  write_file_atomically(path, text);
}

}  // namespace limber::cmd
