#include "gui/views/bar_chart.h"

#include <QPainter>
#include <algorithm>

#include "gui/theme.h"

namespace loci::gui {
namespace {

constexpr int kTitle = 22;
constexpr int kRow = 18;
constexpr int kStandingHeight = 80;
constexpr int kStandingFrom = 12;  // bars
constexpr int kValueWidth = 52;

/// Types are known by the end of their name.
QString label(const std::string& name) {
  return QString::fromStdString(name).section('.', -1);
}

QString number(double value) {
  return QString::number(value, 'g', 8);
}

}  // namespace

BarChart::BarChart(memory::Chart chart, QWidget* parent) : QWidget(parent), chart_(std::move(chart)) {
  setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
}

bool BarChart::stands() const {
  return chart_.bars.size() >= kStandingFrom &&
         std::all_of(chart_.bars.begin(), chart_.bars.end(),
                     [](const auto& bar) { return bar.first.size() <= 2; });
}

QSize BarChart::sizeHint() const {
  const int rows = std::max(1, static_cast<int>(chart_.bars.size()));
  return {320, kTitle + (stands() ? kStandingHeight + kRow : rows * kRow) + 8};
}

QSize BarChart::minimumSizeHint() const {
  return {240, sizeHint().height()};
}

void BarChart::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  const Theme theme = Theme::of(palette());
  QFont bold = font();
  bold.setBold(true);
  painter.setFont(bold);
  painter.setPen(theme.text);
  const QString title = QString::fromStdString(chart_.title);
  painter.drawText(QRect(0, 0, width(), kTitle), Qt::AlignVCenter | Qt::AlignLeft, title);
  const int title_width = QFontMetrics(bold).horizontalAdvance(title);
  painter.setFont(font());
  painter.setPen(theme.muted);
  const QString unit = QString::fromStdString(chart_.unit);
  if (title_width + 12 + fontMetrics().horizontalAdvance(unit) < width())
    painter.drawText(QRect(0, 0, width(), kTitle), Qt::AlignVCenter | Qt::AlignRight, unit);
  double greatest = 0;
  for (const auto& [name, value] : chart_.bars) greatest = std::max(greatest, value);
  if (greatest <= 0)
    painter.drawText(QRect(0, kTitle, width(), kRow), Qt::AlignVCenter | Qt::AlignLeft, "nothing to count");
  else if (stands())
    paint_standing(painter, greatest);
  else
    paint_lying(painter, greatest);
}

void BarChart::paint_lying(QPainter& painter, double greatest) const {
  const Theme theme = Theme::of(palette());
  int names = 0;
  for (const auto& [name, value] : chart_.bars)
    names = std::max(names, fontMetrics().horizontalAdvance(label(name)));
  names = std::min(names, width() * 2 / 5);
  const double room = width() - names - 8 - kValueWidth;
  int y = kTitle;
  for (const auto& [name, value] : chart_.bars) {
    painter.setPen(theme.text);
    painter.drawText(QRect(0, y, names, kRow), Qt::AlignVCenter | Qt::AlignLeft,
                     fontMetrics().elidedText(label(name), Qt::ElideMiddle, names));
    const double length = room * value / greatest;
    painter.fillRect(QRectF(names + 8, y + 3, std::max(length, value > 0 ? 1.0 : 0.0), kRow - 6),
                     theme.accent);
    painter.setPen(theme.muted);
    painter.drawText(QRectF(names + 8 + length + 5, y, kValueWidth, kRow), Qt::AlignVCenter | Qt::AlignLeft,
                     number(value));
    y += kRow;
  }
}

void BarChart::paint_standing(QPainter& painter, double greatest) const {
  const Theme theme = Theme::of(palette());
  const double step = static_cast<double>(width()) / static_cast<double>(chart_.bars.size());
  const double floor = kTitle + kStandingHeight;
  const QFont small = small_font(font());
  painter.setFont(small);
  painter.setPen(theme.grid);
  painter.drawLine(QPointF(0, floor), QPointF(width(), floor));
  double free_from = 0;  // where the next name has room
  for (size_t i = 0; i < chart_.bars.size(); ++i) {
    const auto& [name, value] = chart_.bars[i];
    const double x = step * static_cast<double>(i);
    const double height = (kStandingHeight - 14) * value / greatest;
    painter.fillRect(QRectF(x + 1, floor - height, step - 2, height), theme.accent);
    painter.setPen(theme.muted);
    if (value > 0)
      painter.drawText(QRectF(x - 10, floor - height - 14, step + 20, 14), Qt::AlignCenter, number(value));
    const double wide = QFontMetricsF(small).horizontalAdvance(label(name)) + 4;
    if (x + step / 2 - wide / 2 < free_from) continue;
    painter.drawText(QRectF(x - 10, floor + 2, step + 20, kRow - 2), Qt::AlignCenter, label(name));
    free_from = x + step / 2 + wide / 2;
  }
}

}  // namespace loci::gui
