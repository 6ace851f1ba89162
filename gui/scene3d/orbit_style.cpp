#include "gui/scene3d/orbit_style.h"

#include <vtkCamera.h>
#include <vtkObjectFactory.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "mapping/base/math/math.h"

namespace loci::gui {
namespace {
constexpr int kClickSlack = 3;             // pixels
constexpr double kDegreesPerWindow = 200;  // turned by a drag across the window
constexpr double kSteepest = 88;           // degrees above or below the horizon
}  // namespace

vtkStandardNewMacro(OrbitStyle)

    void OrbitStyle::StartState(int state) {
  if (on_motion) on_motion(true);
  Superclass::StartState(state);
}

void OrbitStyle::StopState() {
  if (on_motion) on_motion(false);
  Superclass::StopState();
}

void OrbitStyle::OnLeftButtonDown() {
  press_x_ = Interactor->GetEventPosition()[0];
  press_y_ = Interactor->GetEventPosition()[1];
  Superclass::OnLeftButtonDown();
}

void OrbitStyle::OnLeftButtonUp() {
  Superclass::OnLeftButtonUp();
  const int* at = Interactor->GetEventPosition();
  if (on_click && std::abs(at[0] - press_x_) <= kClickSlack && std::abs(at[1] - press_y_) <= kClickSlack)
    on_click(at[0], at[1]);
}

bool OrbitStyle::ctrl_wheel(int steps) {
  if (Interactor->GetControlKey() == 0 || !on_ctrl_wheel) return false;
  on_ctrl_wheel(steps);
  return true;
}

void OrbitStyle::OnMouseWheelForward() {
  if (!ctrl_wheel(1)) Superclass::OnMouseWheelForward();
}

void OrbitStyle::OnMouseWheelBackward() {
  if (!ctrl_wheel(-1)) Superclass::OnMouseWheelBackward();
}

void OrbitStyle::Rotate() {
  if (CurrentRenderer == nullptr) return;
  const int* now = Interactor->GetEventPosition();
  const int* before = Interactor->GetLastEventPosition();
  const int* size = CurrentRenderer->GetRenderWindow()->GetSize();
  const double turn = -kDegreesPerWindow * (now[0] - before[0]) / std::max(1, size[0]);
  double lift = -kDegreesPerWindow * (now[1] - before[1]) / std::max(1, size[1]);
  vtkCamera* camera = CurrentRenderer->GetActiveCamera();
  camera->SetViewUp(0, 0, 1);
  const double* forward = camera->GetDirectionOfProjection();
  const double elevation = -std::asin(std::clamp(forward[2], -1.0, 1.0)) * 180 / kPi;
  lift = std::clamp(elevation + lift, -kSteepest, kSteepest) - elevation;
  camera->Azimuth(turn);
  camera->Elevation(lift);
  camera->OrthogonalizeViewUp();
  CurrentRenderer->ResetCameraClippingRange();
  Interactor->Render();
}

}  // namespace loci::gui
