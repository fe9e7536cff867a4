// SPDX-License-Identifier: AGPL-3.0-or-later
// Compiles the shaders with a compiler that is independent of the graphics driver.
#include "render/gl/shader_source.h"

#include <cstdlib>
#include <fstream>
#include <set>

#include <doctest/doctest.h>

#include "render/gl/program.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::render;

namespace {

// Returns the names that a shader tests by `#ifdef NAME` or `defined(NAME)`.
std::set<std::string> switches_of(const std::string& source) {
  std::set<std::string> names;
  const auto add = [&](std::size_t at) {
    std::size_t end = at;
    while (end < source.size() && (std::isalnum(static_cast<unsigned char>(source[end])) || source[end] == '_')) ++end;
    names.insert(source.substr(at, end - at));
  };
  for (const std::string_view ask : {"#ifdef ", "defined("})
    for (std::size_t at = source.find(ask); at != std::string::npos; at = source.find(ask, at + 1))
      add(at + ask.size());
  return names;
}

std::string constants(int atlases) {
  using gl::define;
  const std::string layout = define("ATLASES", atlases) + define("SLOT", 36) + define("APRON", 2) +
                             define("BLOCK", 32) + define("BLOCK_SHIFT", 5) + define("BRICK", 4);
  const std::string ramp = "vec3(0), vec3(1), vec3(0), vec3(1), vec3(0), vec3(1), vec3(0)";
  return layout + define("SURFACE", 98) + define("RAMP_COLOURS", ramp) + define("EXACT_ZERO", "vec3(0)") +
         define("EXACT_ONE", "vec3(1)");
}

}  // namespace

TEST_CASE("shaders: a reference compiler accepts every file with every combination of its switches") {
  if (std::system("command -v glslangValidator > /dev/null") != 0) {
    MESSAGE("SKIPPED: install glslang-tools");
    return;
  }
  const test::TemporaryFolder folder;
  std::string files;
  int count = 0;
  for (const gl::ShaderFile& file : gl::shader_files()) {
    if (file.name.ends_with(".glsl")) continue;
    const std::string name(file.name), plain = gl::shader_source(name);
    const std::set<std::string> switches = switches_of(plain);
    for (int atlases = 1; atlases <= (plain.find("ATLASES") == std::string::npos ? 1 : 4); ++atlases)
      for (unsigned on = 0; on < 1u << switches.size(); ++on) {
        std::string defines = constants(atlases);
        unsigned bit = 0;
        for (const std::string& one : switches)
          if (on >> bit++ & 1) defines += gl::define(one);
        const std::string path = (folder / (std::to_string(count++) + "." + name)).string();
        std::ofstream(path) << gl::shader_source(name, defines);
        files += " " + path;
      }
  }
  CHECK(count > 60);
  const std::string log = (folder / "log").string();
  const int code = std::system(("glslangValidator" + files + " > " + log).c_str());
  std::ifstream in(log);
  const std::string said((std::istreambuf_iterator<char>(in)), {});
  CHECK_MESSAGE(code == 0, said.substr(0, 4000));
  CHECK(said.find("ERROR") == std::string::npos);
}

TEST_CASE("shaders: an included file stands in place of the line that names it, and a name that is none is refused") {
  const std::string source = gl::shader_source("shade.frag", gl::define("POSED"));
  CHECK(source.starts_with("#version 330 core\n#define POSED"));
  CHECK(source.find("uniform vec3 u_base, ") != std::string::npos);
  CHECK(source.find("#include") == std::string::npos);
  CHECK_THROWS_AS(gl::shader_source("nothing.frag"), std::logic_error);
}
