// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/gl/egl_context.h"

#include <mutex>
#include <string>

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include "core/base/error.h"

namespace limber::render {

namespace {

[[noreturn]] void refuse(const std::string& where) {
  throw Error("no picture can be drawn: there is no OpenGL 3.3 without a display here", where,
              "install a graphics driver with EGL (Debian: libegl1 and libgl1-mesa-dri)");
}

// EGL has one display for the whole process, and terminating the display breaks all its contexts. So contexts are
// counted, and the last one to be destroyed, on any thread, terminates the display.
struct Users {
  std::mutex mutex;
  int count = 0;
};
Users& users() {
  static Users all;
  return all;
}

EGLDisplay open_display() {
  const EGLDisplay display = epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_base") &&
                                     epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless")
                                 ? eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr)
                                 : eglGetDisplay(EGL_DEFAULT_DISPLAY);
  EGLint major = 0, minor = 0;
  const std::lock_guard lock(users().mutex);
  if (display == EGL_NO_DISPLAY || !eglInitialize(display, &major, &minor)) refuse("EGL has no display");
  ++users().count;
  return display;
}

EGLContext make_context(EGLDisplay display) {
  if (!eglBindAPI(EGL_OPENGL_API)) refuse("EGL knows no desktop OpenGL");
  const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_DONT_CARE, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (!eglChooseConfig(display, wanted, &config, 1, &count) || count == 0)
    config = nullptr;  // no configuration: some drivers can create a context without one
  const EGLint version[] = {
      EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
  return eglCreateContext(display, config, EGL_NO_CONTEXT, version);
}

}  // namespace

struct HeadlessContext::Impl {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;

  ~Impl() {
    if (display == EGL_NO_DISPLAY) return;
    if (context != EGL_NO_CONTEXT && eglGetCurrentContext() == context)
      eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (context != EGL_NO_CONTEXT) eglDestroyContext(display, context);
    const std::lock_guard lock(users().mutex);
    if (--users().count == 0) eglTerminate(display);
  }
};

HeadlessContext::HeadlessContext() : impl_(std::make_unique<Impl>()) {
  impl_->display = open_display();
  impl_->context = make_context(impl_->display);
  if (impl_->context == EGL_NO_CONTEXT) refuse("the driver is older than OpenGL 3.3");
  if (!eglMakeCurrent(impl_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, impl_->context))
    refuse("the driver needs a window");
  require_opengl_3_3();
}

HeadlessContext::~HeadlessContext() = default;

void require_opengl_3_3() {
  if (epoxy_is_desktop_gl() && epoxy_gl_version() >= 33) return;
  const auto* version = reinterpret_cast<const char*>(glGetString(GL_VERSION));
  throw Error("Limber needs OpenGL 3.3", std::string("this driver offers ") + (version ? version : "none"),
              "update the graphics driver, or set LIBGL_ALWAYS_SOFTWARE=1");
}

}  // namespace limber::render
