#pragma once

#include <vtkInteractorStyleTrackballCamera.h>

#include <functional>

namespace loci::gui {

/// Left drag turns around the vertical, middle drag (or Shift) shifts, right drag and wheel zoom: the floor
/// stays level. A click without a drag selects.
class OrbitStyle : public vtkInteractorStyleTrackballCamera {
 public:
  static OrbitStyle* New();
  vtkTypeMacro(OrbitStyle, vtkInteractorStyleTrackballCamera)

      /// Called with the pixel (from the lower left corner) of a click.
      std::function<void(int x, int y)> on_click;
  /// Called with +1 or -1 for Ctrl and the wheel.
  std::function<void(int steps)> on_ctrl_wheel;

  /// Called when a drag begins (true) and ends (false).
  std::function<void(bool moving)> on_motion;

  void StartState(int state) override;
  void StopState() override;
  void OnLeftButtonDown() override;
  void OnLeftButtonUp() override;
  void OnMouseWheelForward() override;
  void OnMouseWheelBackward() override;
  void OnChar() override {}  // The keys belong to the window's actions.
  void Rotate() override;

 protected:
  OrbitStyle() = default;
  ~OrbitStyle() override = default;

 private:
  bool ctrl_wheel(int steps);

  int press_x_ = 0, press_y_ = 0;
};

}  // namespace loci::gui
