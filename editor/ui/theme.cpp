// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/ui/theme.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/json_text.h"

namespace limber::editor {

namespace {

constexpr std::uint64_t kLargestFile = 1 << 20;

struct Token {
  const char* name;
  Colour& (*colour)(Theme&);
};

constexpr Token kTokens[] = {
    {"void", [](Theme& t) -> Colour& { return t.void_; }},
    {"panel", [](Theme& t) -> Colour& { return t.panel; }},
    {"head", [](Theme& t) -> Colour& { return t.head; }},
    {"raised", [](Theme& t) -> Colour& { return t.raised; }},
    {"hover", [](Theme& t) -> Colour& { return t.hover; }},
    {"active", [](Theme& t) -> Colour& { return t.active; }},
    {"field", [](Theme& t) -> Colour& { return t.field; }},
    {"row_alt", [](Theme& t) -> Colour& { return t.row_alt; }},
    {"line", [](Theme& t) -> Colour& { return t.line; }},
    {"line2", [](Theme& t) -> Colour& { return t.line2; }},
    {"text", [](Theme& t) -> Colour& { return t.text; }},
    {"text2", [](Theme& t) -> Colour& { return t.text2; }},
    {"text3", [](Theme& t) -> Colour& { return t.text3; }},
    {"accent", [](Theme& t) -> Colour& { return t.accent; }},
    {"accent_soft", [](Theme& t) -> Colour& { return t.accent_soft; }},
    {"accent_text", [](Theme& t) -> Colour& { return t.accent_text; }},
    {"on_accent", [](Theme& t) -> Colour& { return t.on_accent; }},
    {"select", [](Theme& t) -> Colour& { return t.select; }},
    {"select_light", [](Theme& t) -> Colour& { return t.select_light; }},
    {"on_select", [](Theme& t) -> Colour& { return t.on_select; }},
    {"ok", [](Theme& t) -> Colour& { return t.ok; }},
    {"warn", [](Theme& t) -> Colour& { return t.warn; }},
    {"error", [](Theme& t) -> Colour& { return t.error; }},
    {"x", [](Theme& t) -> Colour& { return t.axis[0]; }},
    {"y", [](Theme& t) -> Colour& { return t.axis[1]; }},
    {"z", [](Theme& t) -> Colour& { return t.axis[2]; }},
    {"view_top", [](Theme& t) -> Colour& { return t.view_top; }},
    {"view_bottom", [](Theme& t) -> Colour& { return t.view_bottom; }},
    {"view_text", [](Theme& t) -> Colour& { return t.view_text; }},
    {"view_text2", [](Theme& t) -> Colour& { return t.view_text2; }},
    {"view_plate", [](Theme& t) -> Colour& { return t.view_plate; }},
};

bool read_hex(const std::string& text, Colour& colour) {
  if (text.size() != 6 || text.find_first_not_of("0123456789abcdefABCDEF") != std::string::npos) return false;
  const auto value = static_cast<Colour>(std::stoul(text, nullptr, 16));
  colour = 0xFF000000u | (value & 0xFF) << 16 | (value & 0xFF00) | value >> 16;
  return true;
}

double relative_luminance(Colour colour) {
  const auto linear = [&](int shift) {
    const double c = (colour >> shift & 0xFF) / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  };
  return 0.2126 * linear(0) + 0.7152 * linear(8) + 0.0722 * linear(16);
}

}  // namespace

Theme read_theme(const Path& path) {
  const auto json = nlohmann::json::parse(checked_json(read_file(path, kLargestFile), path.string()), nullptr, false);
  if (!json.is_object() || json.value("schema", nlohmann::json()) != "limber-theme/1" || !json.contains("colours"))
    throw Error("this is not a theme", path.string(), "select another theme");
  Theme theme;
  theme.name =
      json.contains("name") && json["name"].is_string() ? json["name"].get<std::string>() : path.stem().string();
  for (const Token& token : kTokens) {
    const auto colour =
        json["colours"].is_object() ? json["colours"].value(token.name, nlohmann::json()) : nlohmann::json();
    if (!colour.is_string() || !read_hex(colour.get<std::string>(), token.colour(theme)))
      throw Error(std::string("the theme lacks the colour '") + token.name + "'", path.string(), "write it as RRGGBB");
  }
  return theme;
}

Colour with_alpha(Colour colour, float alpha) {
  return (colour & 0x00FFFFFFu) | static_cast<Colour>(std::clamp(alpha, 0.0f, 1.0f) * 255 + 0.5f) << 24;
}

Colour rgb(float red, float green, float blue) {
  const auto byte = [](float c) { return static_cast<Colour>(std::clamp(c, 0.0f, 1.0f) * 255 + 0.5f); };
  return 0xFF000000u | byte(blue) << 16 | byte(green) << 8 | byte(red);
}

double contrast(Colour a, Colour b) {
  const double first = relative_luminance(a), second = relative_luminance(b);
  return (std::max(first, second) + 0.05) / (std::min(first, second) + 0.05);
}

}  // namespace limber::editor
