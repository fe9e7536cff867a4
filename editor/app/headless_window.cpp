// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/app/headless_window.h"

#include <algorithm>
#include <utility>

#include <epoxy/gl.h>

#include "render/gl/egl_context.h"

namespace limber::editor {

namespace {

class Picture final : public Offscreen {
 public:
  Picture(const glm::ivec2& size, double monitor_scale) : monitor_scale_(monitor_scale) {
    glGenFramebuffers(1, &framebuffer_);
    glGenRenderbuffers(1, &colours_);
    resize(size);
  }

  ~Picture() override {
    glDeleteRenderbuffers(1, &colours_);
    glDeleteFramebuffers(1, &framebuffer_);
  }

  glm::ivec2 size() const override { return size_; }
  double monitor_scale() const override { return monitor_scale_; }
  bool close_requested() const override { return false; }
  void forget_close_request() override {}
  void wait(double) override {}
  void wake() override {}
  void shift_pointer(const glm::vec2& by) override { shifted_ += by; }
  glm::vec2 shifted() const override { return shifted_; }
  void present(const std::function<void()>& paint) override { paint_ = paint; }

  std::string clipboard() override { return clipboard_; }
  void set_clipboard(const std::string& text) override { clipboard_ = text; }
  void set_cursor(Cursor) override {}
  void set_title(const std::string&) override {}
  void toggle_full_screen() override { full_screen_ = !full_screen_; }
  bool full_screen() const override { return full_screen_; }

  void resize(const glm::ivec2& size) override {
    size_ = size;
    glBindRenderbuffer(GL_RENDERBUFFER, colours_);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, size.x, size.y);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colours_);
  }

  void finish() override {
    paint();
    glFinish();
  }

  render::Image picture() override {
    paint();
    render::Image image{size_, std::vector<std::uint8_t>(std::size_t{4} * size_.x * size_.y)};
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, size_.x, size_.y, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
    const std::size_t row = std::size_t{4} * size_.x;
    for (int y = 0; y < size_.y / 2; ++y)
      std::swap_ranges(image.rgba.begin() + y * row, image.rgba.begin() + (y + 1) * row,
                       image.rgba.begin() + (size_.y - 1 - y) * row);
    for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 255;
    return image;
  }

 private:
  void paint() {
    if (const auto paint = std::exchange(paint_, {})) {
      glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
      paint();
    }
  }

  render::HeadlessContext context_;
  double monitor_scale_;
  unsigned framebuffer_ = 0, colours_ = 0;
  std::function<void()> paint_;
  glm::ivec2 size_{0};
  glm::vec2 shifted_{0};
  std::string clipboard_;
  bool full_screen_ = false;
};

}  // namespace

std::unique_ptr<Offscreen> open_offscreen(const glm::ivec2& size, double monitor_scale) {
  return std::make_unique<Picture>(size, monitor_scale);
}

}  // namespace limber::editor
