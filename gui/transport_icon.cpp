#include "gui/transport_icon.h"

#include <QPainter>
#include <QPixmap>
#include <QPolygonF>

namespace loci::gui {
namespace {

constexpr int kSide = 32;  // drawn large, shown small: sharp on any screen

void triangle(QPainter& painter, double from, double to) {
  painter.drawPolygon(QPolygonF({QPointF(from, 7), QPointF(to, 16), QPointF(from, 25)}));
}

void bar(QPainter& painter, double left, double width) {
  painter.drawRect(QRectF(left, 7, width, 18));
}

}  // namespace

QIcon transport_icon(Transport sign, const QColor& color) {
  QPixmap pixmap(kSide, kSide);
  pixmap.fill(Qt::transparent);
  QPainter painter(&pixmap);
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setPen(Qt::NoPen);
  painter.setBrush(color);
  switch (sign) {
    case Transport::first:
      bar(painter, 7, 3);
      triangle(painter, 25, 11);
      break;
    case Transport::previous:
      triangle(painter, 16, 5);
      triangle(painter, 27, 16);
      break;
    case Transport::play:
      triangle(painter, 9, 26);
      break;
    case Transport::pause:
      bar(painter, 8, 6);
      bar(painter, 18, 6);
      break;
    case Transport::next:
      triangle(painter, 5, 16);
      triangle(painter, 16, 27);
      break;
    case Transport::last:
      triangle(painter, 7, 21);
      bar(painter, 22, 3);
      break;
  }
  return QIcon(pixmap);
}

}  // namespace loci::gui
