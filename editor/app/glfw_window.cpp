// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/app/glfw_window.h"

#include <array>
#include <utility>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <epoxy/gl.h>

#include "core/base/error.h"
#include "core/platform/desktop.h"

namespace limber::editor {

namespace {

// The user cannot make the window smaller, px, because the regions would not fit.
constexpr glm::ivec2 kSmallest = {800, 520};

Key key_of_position(int key) {
  if (key >= GLFW_KEY_A && key <= GLFW_KEY_Z) return static_cast<Key>(static_cast<int>(Key::A) + key - GLFW_KEY_A);
  if (key >= GLFW_KEY_0 && key <= GLFW_KEY_9) return static_cast<Key>(static_cast<int>(Key::Digit0) + key - GLFW_KEY_0);
  if (key >= GLFW_KEY_F1 && key <= GLFW_KEY_F12) return static_cast<Key>(static_cast<int>(Key::F1) + key - GLFW_KEY_F1);
  if (key >= GLFW_KEY_KP_0 && key <= GLFW_KEY_KP_9)
    return static_cast<Key>(static_cast<int>(Key::Num0) + key - GLFW_KEY_KP_0);
  constexpr std::pair<int, Key> kOthers[] = {{GLFW_KEY_SPACE, Key::Space},
                                             {GLFW_KEY_TAB, Key::Tab},
                                             {GLFW_KEY_ENTER, Key::Return},
                                             {GLFW_KEY_ESCAPE, Key::Escape},
                                             {GLFW_KEY_BACKSPACE, Key::Backspace},
                                             {GLFW_KEY_DELETE, Key::Delete},
                                             {GLFW_KEY_INSERT, Key::Insert},
                                             {GLFW_KEY_LEFT, Key::Left},
                                             {GLFW_KEY_RIGHT, Key::Right},
                                             {GLFW_KEY_UP, Key::Up},
                                             {GLFW_KEY_DOWN, Key::Down},
                                             {GLFW_KEY_PAGE_UP, Key::PageUp},
                                             {GLFW_KEY_PAGE_DOWN, Key::PageDown},
                                             {GLFW_KEY_HOME, Key::Home},
                                             {GLFW_KEY_END, Key::End},
                                             {GLFW_KEY_COMMA, Key::Comma},
                                             {GLFW_KEY_PERIOD, Key::Period},
                                             {GLFW_KEY_MINUS, Key::Minus},
                                             {GLFW_KEY_EQUAL, Key::Plus},
                                             {GLFW_KEY_SLASH, Key::Slash},
                                             {GLFW_KEY_SEMICOLON, Key::Semicolon},
                                             {GLFW_KEY_APOSTROPHE, Key::Quote},
                                             {GLFW_KEY_BACKSLASH, Key::Backslash},
                                             {GLFW_KEY_LEFT_BRACKET, Key::BracketLeft},
                                             {GLFW_KEY_RIGHT_BRACKET, Key::BracketRight},
                                             {GLFW_KEY_GRAVE_ACCENT, Key::Backtick},
                                             {GLFW_KEY_KP_DECIMAL, Key::NumPeriod},
                                             {GLFW_KEY_KP_DIVIDE, Key::NumSlash},
                                             {GLFW_KEY_KP_MULTIPLY, Key::NumTimes},
                                             {GLFW_KEY_KP_SUBTRACT, Key::NumMinus},
                                             {GLFW_KEY_KP_ADD, Key::NumPlus},
                                             {GLFW_KEY_KP_ENTER, Key::NumEnter},
                                             {GLFW_KEY_LEFT_CONTROL, Key::Ctrl},
                                             {GLFW_KEY_RIGHT_CONTROL, Key::Ctrl},
                                             {GLFW_KEY_LEFT_SHIFT, Key::Shift},
                                             {GLFW_KEY_RIGHT_SHIFT, Key::Shift},
                                             {GLFW_KEY_LEFT_ALT, Key::Alt},
                                             {GLFW_KEY_RIGHT_ALT, Key::Alt},
                                             {GLFW_KEY_LEFT_SUPER, Key::Super},
                                             {GLFW_KEY_RIGHT_SUPER, Key::Super}};
  for (const auto& [theirs, ours] : kOthers)
    if (theirs == key) return ours;
  return Key::None;
}

// Returns the letter that the user's keyboard layout has on the key. If this is no Latin letter, returns the key that
// the US layout has at this position.
Key key_of(int key, int scancode) {
  const Key position = key_of_position(key);
  if (key < GLFW_KEY_A || key > GLFW_KEY_Z) return position;
  const char* printed = glfwGetKeyName(key, scancode);
  if (!printed || printed[1] != 0) return position;
  const char letter = printed[0];
  if (letter >= 'a' && letter <= 'z') return static_cast<Key>(static_cast<int>(Key::A) + letter - 'a');
  return position;
}

class Window final : public Host {
 public:
  Window(const glm::ivec2& size, const std::string& title) {
    static std::string reason;
    glfwSetErrorCallback([](int, const char* text) { reason = text; });
    if (!glfwInit())
      throw Error("no display can be reached", reason,
                  "start the editor in a graphical session, or use the command line (limber --help)");
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    glfwWindowHintString(GLFW_X11_CLASS_NAME, "limber");
    glfwWindowHintString(GLFW_X11_INSTANCE_NAME, "limber");
    window_ = glfwCreateWindow(size.x, size.y, title.c_str(), nullptr, nullptr);
    if (!window_) {
      const std::string why = reason;
      glfwTerminate();
      throw Error("the window cannot be opened", why, "update the graphics driver: OpenGL 3.3 is needed");
    }
    glfwSetWindowSizeLimits(window_, kSmallest.x, kSmallest.y, GLFW_DONT_CARE, GLFW_DONT_CARE);
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);
    glfwSetWindowUserPointer(window_, this);
    set_callbacks();
    constexpr int kShapes[] = {GLFW_ARROW_CURSOR,   GLFW_HAND_CURSOR,      GLFW_IBEAM_CURSOR, GLFW_HRESIZE_CURSOR,
                               GLFW_VRESIZE_CURSOR, GLFW_CROSSHAIR_CURSOR, GLFW_HAND_CURSOR};
    for (std::size_t i = 0; i < cursors_.size(); ++i) cursors_[i] = glfwCreateStandardCursor(kShapes[i]);
  }

  ~Window() override {
    for (GLFWcursor* cursor : cursors_)
      if (cursor) glfwDestroyCursor(cursor);
    glfwDestroyWindow(window_);
    glfwTerminate();
  }

  glm::ivec2 size() const override {
    glm::ivec2 size;
    glfwGetFramebufferSize(window_, &size.x, &size.y);
    return size;
  }
  double monitor_scale() const override {
    float x = 1, y = 1;
    glfwGetWindowContentScale(window_, &x, &y);
    return x;
  }
  bool close_requested() const override { return glfwWindowShouldClose(window_); }
  void forget_close_request() override { glfwSetWindowShouldClose(window_, GLFW_FALSE); }

  void wait(double seconds) override {
    if (seconds > 0) glfwWaitEventsTimeout(seconds);
    else glfwPollEvents();
  }
  void wake() override { glfwPostEmptyEvent(); }
  void shift_pointer(const glm::vec2& by) override {
    double x = 0, y = 0;
    glfwGetCursorPos(window_, &x, &y);
    const glm::vec2 units = by / pixels(1, 1);
    glfwSetCursorPos(window_, x + units.x, y + units.y);
  }
  void present(const std::function<void()>& paint) override {
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    paint();
    glfwSwapBuffers(window_);
  }

  std::string clipboard() override {
    const char* text = glfwGetClipboardString(window_);
    return text ? text : "";
  }
  void set_clipboard(const std::string& text) override { glfwSetClipboardString(window_, text.c_str()); }
  void set_cursor(Cursor cursor) override {
    if (cursor == cursor_) return;
    glfwSetInputMode(window_, GLFW_CURSOR, cursor == Cursor::Hidden ? GLFW_CURSOR_HIDDEN : GLFW_CURSOR_NORMAL);
    if (cursor != Cursor::Hidden) glfwSetCursor(window_, cursors_[static_cast<std::size_t>(cursor)]);
    cursor_ = cursor;
  }
  void set_title(const std::string& title) override { glfwSetWindowTitle(window_, title.c_str()); }
  void toggle_full_screen() override;
  bool open_file(const Path& path) override;

 private:
  static Window& of(GLFWwindow* window) { return *static_cast<Window*>(glfwGetWindowUserPointer(window)); }
  void set_callbacks();
  // Converts GLFW's window coordinates to pixels. On some desktops, GLFW's units are larger than pixels.
  glm::vec2 pixels(double x, double y) const {
    glm::ivec2 units;
    glfwGetWindowSize(window_, &units.x, &units.y);
    return glm::vec2(x, y) * glm::vec2(size()) / glm::vec2(glm::max(units, 1));
  }

  GLFWwindow* window_ = nullptr;
  std::array<GLFWcursor*, 7> cursors_{};
  Cursor cursor_ = Cursor::Arrow;
  glm::ivec4 windowed_{0};  // position (x, y) and size (z, w) of the window before full screen, to restore them
};

void Window::set_callbacks() {
  glfwSetCursorPosCallback(
      window_, [](GLFWwindow* w, double x, double y) { of(w).events.push(PointerMoved{of(w).pixels(x, y)}); });
  glfwSetCursorEnterCallback(window_, [](GLFWwindow* w, int entered) {
    // While a button is held, a drag continues outside the window, so nothing is sent when the pointer leaves it.
    for (int button = 0; button <= GLFW_MOUSE_BUTTON_MIDDLE; ++button)
      if (glfwGetMouseButton(w, button) == GLFW_PRESS) return;
    if (!entered) of(w).events.push(PointerMoved{glm::vec2(-1e6f)});
  });
  glfwSetMouseButtonCallback(window_, [](GLFWwindow* w, int button, int action, int) {
    if (button > GLFW_MOUSE_BUTTON_MIDDLE) return;
    of(w).events.push(ButtonChanged{static_cast<MouseButton>(button), action == GLFW_PRESS});
  });
  glfwSetScrollCallback(window_, [](GLFWwindow* w, double x, double y) {
    // Some desktops turn Shift+wheel into horizontal scrolling. This turns it back into vertical scrolling.
    const bool shift =
        glfwGetKey(w, GLFW_KEY_LEFT_SHIFT) == GLFW_PRESS || glfwGetKey(w, GLFW_KEY_RIGHT_SHIFT) == GLFW_PRESS;
    if (shift && y == 0) std::swap(x, y);
    if (x != 0 || y != 0) of(w).events.push(Wheeled{static_cast<float>(y), static_cast<float>(x)});
  });
  glfwSetKeyCallback(window_, [](GLFWwindow* w, int key, int scancode, int action, int) {
    if (const Key ours = key_of(key, scancode); ours != Key::None)
      of(w).events.push(KeyChanged{ours, action != GLFW_RELEASE, action == GLFW_REPEAT});
  });
  glfwSetCharCallback(window_, [](GLFWwindow* w, unsigned character) {
    of(w).events.push(TextTyped{static_cast<char32_t>(character)});
  });
  glfwSetDropCallback(window_, [](GLFWwindow* w, int count, const char** names) {
    of(w).events.push(FilesDropped{std::vector<Path>(names, names + count)});
  });
  glfwSetWindowFocusCallback(window_,
                             [](GLFWwindow* w, int focused) { of(w).events.push(FocusChanged{focused == GLFW_TRUE}); });
}

bool Window::open_file(const Path& path) { return open_in_default_program(path); }

void Window::toggle_full_screen() {
  if (glfwGetWindowMonitor(window_)) {
    glfwSetWindowMonitor(window_, nullptr, windowed_.x, windowed_.y, windowed_.z, windowed_.w, GLFW_DONT_CARE);
    return;
  }
  GLFWmonitor* monitor = glfwGetPrimaryMonitor();
  const GLFWvidmode* mode = monitor ? glfwGetVideoMode(monitor) : nullptr;
  if (!mode) return;
  glfwGetWindowPos(window_, &windowed_.x, &windowed_.y);
  glfwGetWindowSize(window_, &windowed_.z, &windowed_.w);
  glfwSetWindowMonitor(window_, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
}

}  // namespace

}  // namespace limber::editor

extern "C" limber::editor::Host* limber_open_window(const glm::ivec2& size, const std::string& title) {
  return new limber::editor::Window(size, title);
}
