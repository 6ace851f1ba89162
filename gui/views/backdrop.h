#pragma once

#include <QPainter>
#include <QPixmap>
#include <functional>

class QWidget;

namespace loci {

/// What a widget would paint the same again and again, as a picture. Made anew after forget(), and when size
/// or colours of the widget are others.
class Backdrop {
 public:
  void forget() { picture_ = {}; }
  void paint(const QWidget& widget, QPainter& painter, const std::function<void(QPainter&)>& draw);

 private:
  QPixmap picture_;
  qint64 palette_ = 0;
};

}  // namespace loci
