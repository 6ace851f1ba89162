#pragma once

#include <QPainter>
#include <QPixmap>
#include <QWidget>
#include <functional>

class QTableView;

namespace loci::gui {

/// A view in a dock that may be behind others: it reads and lays out only while it is in front. (Qt counts a
/// dock behind another tab as visible.)
class Page : public QWidget {
  Q_OBJECT

 public:
  using QWidget::QWidget;

  /// Called by the owner of the dock.
  void set_in_front(bool in_front);
  bool is_in_front() const { return in_front_; }

 protected:
  /// The page has come to the front: show what was left out.
  virtual void came_to_front() = 0;

 private:
  bool in_front_ = false;
};

/// Caches as an image what a widget paints the same at each change. Painted again after forget(), and when
/// size or colours of the widget have changed.
class Backdrop {
 public:
  void forget() { image_ = {}; }
  void paint(const QWidget& widget, QPainter& painter, const std::function<void(QPainter&)>& draw);

 private:
  QPixmap image_;
  qint64 palette_ = 0;
};

/// Tables of lines: whole rows are selected, no grid, rows as high as the text.
void style_table(QTableView& table);

}  // namespace loci::gui
