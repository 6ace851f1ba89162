#include "gui/scene3d/egl_window.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>

#include <array>

#include "mapping/base/error.h"

namespace loci::gui {
namespace {

/// GLEW in Debian is built for GLX: it loads all functions and then complains that there is no X display.
/// They work all the same, so the window is marked as ready.
class EglRenderWindow : public vtkGenericOpenGLRenderWindow {
 public:
  static EglRenderWindow* New();
  vtkTypeMacro(EglRenderWindow, vtkGenericOpenGLRenderWindow)

      EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;

  void MakeCurrent() override { eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context); }
  bool IsCurrent() override { return eglGetCurrentContext() == context; }

  void OpenGLInitContext() override {
    const int shown = vtkObject::GetGlobalWarningDisplay();
    vtkObject::GlobalWarningDisplayOff();
    Superclass::OpenGLInitContext();
    vtkObject::SetGlobalWarningDisplay(shown);
    GlewInitValid = true;
    Initialized = true;
  }

 protected:
  EglRenderWindow() = default;
  ~EglRenderWindow() override = default;
};
vtkStandardNewMacro(EglRenderWindow)

    EGLDisplay surfaceless_display() {
  const auto get_display =
      reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
  if (get_display == nullptr) return EGL_NO_DISPLAY;
  return get_display(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
}

EGLContext core_context(EGLDisplay display) {
  if (eglBindAPI(EGL_OPENGL_API) == EGL_FALSE) return EGL_NO_CONTEXT;
  const std::array<EGLint, 5> config_wanted = {EGL_SURFACE_TYPE, EGL_DONT_CARE, EGL_RENDERABLE_TYPE,
                                               EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (eglChooseConfig(display, config_wanted.data(), &config, 1, &count) == EGL_FALSE || count == 0)
    return EGL_NO_CONTEXT;
  const std::array<EGLint, 7> wanted = {EGL_CONTEXT_MAJOR_VERSION,
                                        3,
                                        EGL_CONTEXT_MINOR_VERSION,
                                        2,
                                        EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                        EGL_NONE};
  return eglCreateContext(display, config, EGL_NO_CONTEXT, wanted.data());
}

}  // namespace

struct EglWindow::Impl {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
  vtkNew<EglRenderWindow> window;

  ~Impl() {
    if (context == EGL_NO_CONTEXT) return;
    window->MakeCurrent();
    window->Finalize();
    eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display, context);
  }
};

EglWindow::EglWindow(int width, int height) : impl_(std::make_unique<Impl>()) {
  const std::string hint = "install libgl1-mesa-dri and libegl1, or run under xvfb-run";
  impl_->display = surfaceless_display();
  if (impl_->display == EGL_NO_DISPLAY || eglInitialize(impl_->display, nullptr, nullptr) == EGL_FALSE)
    throw Error("cannot draw in 3D: no EGL display without a screen", {}, hint);
  impl_->context = core_context(impl_->display);
  if (impl_->context == EGL_NO_CONTEXT)
    throw Error("cannot draw in 3D: no OpenGL 3.2 context through EGL", {}, hint);
  auto* window = impl_->window.Get();
  window->display = impl_->display;
  window->context = impl_->context;
  window->MakeCurrent();
  window->SetReadyForRendering(true);
  window->SetIsCurrent(true);
  window->SetSupportsOpenGL(1);
  window->SetMultiSamples(0);
  window->SetOffScreenRendering(1);
  window->SetShowWindow(false);
  window->SetSize(width, height);
  window->OpenGLInit();
}

EglWindow::~EglWindow() = default;

vtkRenderWindow* EglWindow::window() const {
  return impl_->window;
}

}  // namespace loci::gui
