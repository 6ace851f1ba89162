#include "gui/core/text.h"

#include <QImage>
#include <QPainter>
#include <cmath>
#include <cstdlib>

namespace loci::gui {

QString time_text(TimeNs time, const TimeZone& zone) {
  // ISO 8601 with the zone at its end: "2026-05-01T09:10:00.5+02:00".
  QString text = QString::fromStdString(zone.format(time));
  text.replace('T', ' ');
  const int zone_at = text.lastIndexOf(QRegExp("[Z+-]"));
  return zone_at > 10 ? text.left(zone_at) : text;
}

QString zone_text(TimeNs time, const TimeZone& zone) {
  QString name = QString::fromStdString(zone.name());
  const int minutes = zone.minutes_at(time);
  if (name == "UTC") return name;
  const QString offset = QString("UTC%1%2:%3")
                             .arg(minutes < 0 ? "−" : "+")
                             .arg(std::abs(minutes) / 60, 2, 10, QChar('0'))
                             .arg(std::abs(minutes) % 60, 2, 10, QChar('0'));
  return name[0].isLetter() ? name + ", " + offset : offset;
}

QString duration_text(TimeNs from, TimeNs to) {
  const TimeNs span = to - from;
  if (span < kSecond) return "just now";
  if (span < kMinute) return QString("%1 s").arg(span / kSecond);
  if (span < kHour) return QString("%1 min").arg(span / kMinute);
  if (span < kDay) return QString("%1 h %2 min").arg(span / kHour).arg(span % kHour / kMinute);
  return span < 2 * kDay ? QString("%1 h").arg(span / kHour) : QString("%1 days").arg(span / kDay);
}

QString apart_text(TimeNs scene, TimeNs time) {
  if (scene > time) return duration_text(time, scene) + " later";
  return time - scene < kMinute ? QString() : duration_text(scene, time) + " before";
}

QString percent_text(double probability) {
  // 100 % is kept for what is certain.
  if (probability < 1 && probability > 0.995) return "> 99 %";
  if (probability > 0 && probability < 0.005) return "< 1 %";
  return QString("%1 %").arg(std::lround(probability * 100));
}

QPixmap swatch(const std::array<uint8_t, 3>& rgb, int side) {
  QPixmap pixmap(side, side);
  pixmap.fill(Qt::transparent);
  QPainter painter(&pixmap);
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setPen(QPen(QColor(0, 0, 0, 90), 1));
  painter.setBrush(QColor(rgb[0], rgb[1], rgb[2]));
  painter.drawRoundedRect(QRectF(0.5, 0.5, side - 1.0, side - 1.0), 3, 3);
  return pixmap;
}

QPixmap centred(const QPixmap& image, int side) {
  QPixmap square(side, side);
  square.fill(Qt::transparent);
  QPainter(&square).drawPixmap((side - image.width()) / 2, (side - image.height()) / 2, image);
  return square;
}

QImage image_of(const cv::Mat& bgr) {
  if (bgr.empty()) return {};
  return QImage(bgr.data, bgr.cols, bgr.rows, static_cast<int>(bgr.step), QImage::Format_BGR888).copy();
}

}  // namespace loci::gui
