#pragma once

#include <QImage>
#include <QWidget>
#include <functional>

class vtkInteractorStyle;
class vtkRenderWindow;

namespace loci::gui {

/// How the 3D view gets its pixels.
enum class MapBackend {
  widget,  ///< an OpenGL widget on a screen
  memory   ///< drawn through EGL and painted as an image: without any screen, and where no graphics card
           ///< draws
};

/// Where the 3D view is drawn and moved with the mouse. Several requests to draw become
/// one image.
class MapCanvas : public QWidget {
  Q_OBJECT

 public:
  /// Error when the backend cannot draw.
  static MapCanvas* make(MapBackend backend, QWidget* parent);

  virtual vtkRenderWindow* window() const = 0;
  virtual void set_style(vtkInteractorStyle* style) = 0;
  virtual void redraw() = 0;
  /// Draws now. Null when that is impossible.
  virtual QImage image() = 0;

 Q_SIGNALS:
  void drawn();

 protected:
  using QWidget::QWidget;
};

}  // namespace loci::gui
