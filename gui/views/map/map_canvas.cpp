#include "gui/views/map/map_canvas.h"

#include <QVTKInteractor.h>
#include <QVTKInteractorAdapter.h>
#include <QVTKOpenGLNativeWidget.h>
#include <vtkCallbackCommand.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkInteractorStyle.h>
#include <vtkNew.h>
#include <vtkUnsignedCharArray.h>
#include <QEvent>
#include <QPainter>
#include <QTimer>
#include <QVBoxLayout>

#include <cstring>
#include <utility>

#include "gui/core/task_timer.h"
#include "gui/scene3d/egl_window.h"

namespace loci::gui {
namespace {

QImage pixels_of(vtkRenderWindow* window) {
  const int* size = window->GetSize();
  vtkNew<vtkUnsignedCharArray> pixels;
  window->GetRGBACharPixelData(0, 0, size[0] - 1, size[1] - 1, 0, pixels);
  QImage image(size[0], size[1], QImage::Format_RGBX8888);
  const auto row = static_cast<size_t>(size[0]) * 4;
  for (int y = 0; y < size[1]; ++y)
    std::memcpy(image.scanLine(size[1] - 1 - y), pixels->GetPointer(y * static_cast<vtkIdType>(row)), row);
  return image;
}

/// The graphics card draws straight onto the screen.
class WidgetCanvas : public MapCanvas {
 public:
  explicit WidgetCanvas(QWidget* parent) : MapCanvas(parent), widget_(new QVTKOpenGLNativeWidget(this)) {
    vtkNew<vtkGenericOpenGLRenderWindow> made;
    made->SetMultiSamples(0);
    widget_->setRenderWindow(made);
    auto* layout = new QVBoxLayout(this);
    layout->setContentsMargins(0, 0, 0, 0);
    layout->addWidget(widget_);
  }

  vtkRenderWindow* window() const override { return widget_->renderWindow(); }
  void set_style(vtkInteractorStyle* style) override { window()->GetInteractor()->SetInteractorStyle(style); }
  void redraw() override {
    if (!isVisible() || std::exchange(due_, true)) return;
    QTimer::singleShot(0, this, [this] {
      due_ = false;
      {
        const DrawingScope drawing;
        window()->Render();
      }
      Q_EMIT drawn();
    });
  }
  QImage image() override {
    window()->Render();
    return widget_->grab().toImage();
  }

 private:
  QVTKOpenGLNativeWidget* widget_;
  bool due_ = false;
};

/// Drawn in memory. Without a graphics card this is several times as fast as a widget, for which the whole
/// window would be put together by the same slow means.
class MemoryCanvas : public MapCanvas {
 public:
  explicit MemoryCanvas(QWidget* parent) : MapCanvas(parent), egl_(parent->width(), parent->height()) {
    setAttribute(Qt::WA_OpaquePaintEvent);
    interactor_->SetRenderWindow(egl_.window());
    interactor_->Initialize();
    interactor_->EnableRenderOff();  // not at once, but when it is painted
    vtkNew<vtkCallbackCommand> command;
    command->SetClientData(this);
    command->SetCallback(
        [](vtkObject*, unsigned long, void* canvas, void*) { static_cast<MemoryCanvas*>(canvas)->redraw(); });
    interactor_->AddObserver(vtkCommand::RenderEvent, command);
  }
  ~MemoryCanvas() override { interactor_->RemoveObservers(vtkCommand::RenderEvent); }

  vtkRenderWindow* window() const override { return egl_.window(); }
  void set_style(vtkInteractorStyle* style) override { interactor_->SetInteractorStyle(style); }
  void redraw() override {
    due_ = true;
    update();
  }
  QImage image() override {
    due_ = false;
    window()->Render();
    image_ = pixels_of(window());
    image_.setDevicePixelRatio(devicePixelRatioF());
    return image_;
  }

 protected:
  bool event(QEvent* event) override {
    switch (event->type()) {
      case QEvent::MouseButtonPress:
      case QEvent::MouseButtonRelease:
      case QEvent::MouseButtonDblClick:
      case QEvent::MouseMove:
      case QEvent::Wheel:
        adapter_.ProcessEvent(event, interactor_);
        event->accept();
        return true;
      default:
        return QWidget::event(event);
    }
  }
  void paintEvent(QPaintEvent*) override {
    const bool was_due = due_ || image_.isNull();
    if (was_due) image();
    QPainter(this).drawImage(0, 0, image_);
    if (was_due) Q_EMIT drawn();
  }
  void resizeEvent(QResizeEvent*) override {
    const double ratio = devicePixelRatioF();
    adapter_.SetDevicePixelRatio(static_cast<float>(ratio), interactor_);
    const QSize pixels = size() * ratio;
    egl_.window()->SetSize(pixels.width(), pixels.height());
    interactor_->UpdateSize(pixels.width(), pixels.height());
    redraw();
  }

 private:
  EglWindow egl_;
  vtkNew<QVTKInteractor> interactor_;
  QVTKInteractorAdapter adapter_;
  QImage image_;
  bool due_ = true;
};

}  // namespace

MapCanvas* MapCanvas::make(MapBackend backend, QWidget* parent) {
  if (backend == MapBackend::widget) return new WidgetCanvas(parent);
  return new MemoryCanvas(parent);
}

}  // namespace loci::gui
