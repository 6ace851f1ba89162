#pragma once

#include <QPainter>
#include <QPixmap>
#include <functional>

class QWidget;

namespace loci::gui {

/// What a widget would paint the same again and again, as an image. Made anew after forget(), and when size
/// or colours of the widget are others.
class Backdrop {
 public:
  void forget() { image_ = {}; }
  void paint(const QWidget& widget, QPainter& painter, const std::function<void(QPainter&)>& draw);

 private:
  QPixmap image_;
  qint64 palette_ = 0;
};

}  // namespace loci::gui
