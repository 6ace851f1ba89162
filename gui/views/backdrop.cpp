#include "gui/views/backdrop.h"

#include <QWidget>

namespace loci::gui {

void Backdrop::paint(const QWidget& widget, QPainter& painter, const std::function<void(QPainter&)>& draw) {
  const double ratio = widget.devicePixelRatioF();
  const QSize pixels = widget.size() * ratio;
  if (image_.size() != pixels || palette_ != widget.palette().cacheKey()) {
    image_ = QPixmap(pixels);
    image_.setDevicePixelRatio(ratio);
    image_.fill(Qt::transparent);
    palette_ = widget.palette().cacheKey();
    QPainter inside(&image_);
    inside.setRenderHint(QPainter::Antialiasing);
    inside.setFont(widget.font());
    draw(inside);
  }
  painter.drawPixmap(0, 0, image_);
}

}  // namespace loci::gui
