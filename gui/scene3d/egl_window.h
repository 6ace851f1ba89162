#pragma once

#include <memory>

class vtkRenderWindow;

namespace loci::gui {

/// A VTK render window that draws into memory through EGL, without any X server.
class EglWindow {
 public:
  /// Error with the reason when no OpenGL context can be made this way.
  EglWindow(int width, int height);
  ~EglWindow();
  EglWindow(const EglWindow&) = delete;
  EglWindow& operator=(const EglWindow&) = delete;

  vtkRenderWindow* window() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace loci::gui
