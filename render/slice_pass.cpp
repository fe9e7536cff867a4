// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/slice_pass.h"

#include <string>

#include <epoxy/gl.h>

#include "render/view_rays.h"

namespace limber::render {

namespace {

// The label index stays with the field that rays use, since only it says which blocks are there; a slice needs every block.
const char* const kSlice = R"(
in vec2 ndc;
uniform usampler3D u_index;
uniform usampler2D u_looks;
uniform vec3 u_middle, u_right, u_down;   // padded coordinates; a pixel right, a pixel down
uniform vec3 u_high;
uniform vec2 u_size;
uniform bool u_outline;
uniform uint u_outlined;
layout(location = 0) out vec4 colour;

#ifdef WEIGHTS
uniform float u_contours;
const float kContour = 0.55, kTissueBorder = 0.86;
#endif

vec3 place_of(vec2 pixel) {
  vec3 p = u_middle + pixel.x * u_right + pixel.y * u_down;
#ifdef POSED
  p = rest_of(p);
#endif
  return p;
}

uint label_at_place(vec3 p) {
  if (any(lessThan(p, vec3(0.0))) || any(greaterThanEqual(p, u_high))) return 0u;
  uvec4 entry = texelFetch(u_index, ivec3(p) / BLOCK, 0);
  if (entry.w == 0u) return 0u;
  return label_at(entry.w, ivec3(p) % BLOCK + ivec3(entry.xyz) * SLOT + APRON);
}

uvec4 look_of(uint label) { return texelFetch(u_looks, ivec2(label & 255u, label >> 8), 0); }

#ifdef WEIGHTS
// How much of the pixel lines cover.
float contour(vec4 texel, vec3 right, vec3 below) {
#ifdef RAMP
  float level = texel.r / max(texel.a, 1e-3);
  vec2 slope = abs(vec2(dFdx(level), dFdy(level)));
  float off = min(min(abs(level - 0.25), abs(level - 0.5)), abs(level - 0.75));
  // A steep one is a fold or the border of the tissue.
  return texel.a > 0.0 && all(lessThan(slope, vec2(0.3))) ? clamp(1.1 - off / max(length(slope), 1e-4), 0.0, 1.0) : 0.0;
#elif defined(VOXELS)
  vec4 to_right = weights_at(right), to_below = weights_at(below);
  return (to_right.a > 0.0 && to_right != texel) || (to_below.a > 0.0 && to_below != texel) ? 1.0 : 0.0;
#else
  return 0.0;
#endif
}
#endif

void main() {
  vec2 pixel = vec2(gl_FragCoord.x - u_size.x * 0.5, u_size.y * 0.5 - gl_FragCoord.y);
  vec3 p = place_of(pixel), p_right = place_of(pixel + vec2(1, 0)), p_below = place_of(pixel + vec2(0, 1));
  uint label = label_at_place(p);
  uvec4 look = look_of(label);
  bool seen = (look.a & 7u) != 0u;
  float alpha = seen ? 1.0 : 0.0;
  uint right = label_at_place(p_right), below = label_at_place(p_below);
  bool border = right != label || below != label;
  if (u_outline) {
    // The border belongs to whichever side is seen.
    if (!seen && border) look = look_of((look_of(right).a & 7u) != 0u ? right : below);
    alpha = border && (look.a & 7u) != 0u ? 1.0 : seen ? 0.10 : 0.0;
  }
  vec3 rgb = vec3(look.rgb) / 255.0;
#ifdef WEIGHTS
  vec4 texel = weights_at(p);
  float line = u_contours * contour(texel, p_right, p_below);
  if (seen && !(u_outline && border)) {
    vec4 weight = weight_colour(texel);
    if (weight.a > 0.0) {
      rgb = weight.rgb * (border ? kTissueBorder : 1.0) * mix(1.0, kContour, line);
      alpha = 1.0;
    }
  }
#endif
  if (u_outlined != 0u && border && (label == u_outlined || right == u_outlined || below == u_outlined)) { rgb = vec3(1.0, 0.624, 0.18); alpha = 1.0; }
  colour = vec4(rgb * alpha, alpha);
}
)";

}  // namespace

SlicePass::SlicePass() : nothing_(gl::VertexArray::create()) {}

void SlicePass::draw(const VolumeTexture& volume, const PosedTexture* posed, const LooksTexture& looks, const WeightTexture* weights, bool contours,
                     const SliceCamera& camera, SliceDisplay display, std::optional<Label> outlined, const glm::ivec2& size) {
  auto& program = programs_[{volume.layout().atlases, posed != nullptr, weights ? std::optional(weights->reading()) : std::nullopt}];
  if (!program) {
    const auto define = [](const char* name, int value) { return "#define " + std::string(name) + " " + std::to_string(value) + "\n"; };
    program = std::make_unique<gl::Program>("slice", gl::kWholePicture,
                                            define("SLOT", kSlot) + define("APRON", kApron) + define("BLOCK", kBlock) +
                                                atlas_functions(volume.layout().atlases) +
                                                (posed ? std::string("#define POSED\n") + kPosedFunctions : "") +
                                                (weights ? "#define WEIGHTS\n" + weight_functions(volume.layout().atlases, weights->reading()) : "") + kSlice);
  }
  const AffineTransform to_padded = padded_from_world(volume.grid());
  const SliceFrame frame = frame_of(camera.axis);
  program->use();
  int unit = volume.bind(*program, 0);
  program->set_texture("u_index", unit++, GL_TEXTURE_3D, volume.index().name());
  program->set_texture("u_looks", unit++, GL_TEXTURE_2D, looks.texture().name());
  if (posed) unit = posed->bind(volume, *program, unit);
  if (weights) {
    weights->bind(volume, *program, unit);
    program->set("u_contours", contours ? 1.0f : 0.0f);
  }
  program->set("u_middle", glm::vec3(to_padded * camera.centre));
  program->set("u_right", glm::vec3(to_padded.linear * frame.right * camera.millimetres_per_pixel));
  program->set("u_down", glm::vec3(to_padded.linear * frame.down * camera.millimetres_per_pixel));
  program->set("u_high", glm::vec3(volume.layout().blocks * kBlock));
  program->set("u_size", glm::vec2(size));
  program->set("u_outline", display == SliceDisplay::Outline ? 1 : 0);
  program->set("u_outlined", static_cast<unsigned>(outlined.value_or(0)));
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_SCISSOR_TEST);
  glViewport(0, 0, size.x, size.y);
  glBindVertexArray(nothing_.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
}

}  // namespace limber::render
