#include "gui/core/widgets.h"

#include <QHeaderView>
#include <QTableView>

namespace loci::gui {

void Page::set_in_front(bool in_front) {
  if (in_front_ == in_front) return;
  in_front_ = in_front;
  if (in_front_) came_to_front();
}

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

void style_table(QTableView& table) {
  table.setSelectionBehavior(QAbstractItemView::SelectRows);
  table.setEditTriggers(QAbstractItemView::NoEditTriggers);
  table.setShowGrid(false);
  table.setWordWrap(false);  // what does not fit is cut off at its end, not after its first word
  table.verticalHeader()->hide();
  table.verticalHeader()->setDefaultSectionSize(table.fontMetrics().height() + 6);
  table.horizontalHeader()->setDefaultAlignment(Qt::AlignLeft | Qt::AlignVCenter);
  table.horizontalHeader()->setHighlightSections(false);
}

}  // namespace loci::gui
