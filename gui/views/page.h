#pragma once

#include <QWidget>

namespace loci::gui {

/// A view in a dock that may be behind others: it reads and lays out only while it is looked at. (A dock
/// behind another tab counts as visible for Qt.)
class Page : public QWidget {
  Q_OBJECT

 public:
  using QWidget::QWidget;

  /// Told by whoever knows the dock.
  void set_looked_at(bool looked_at);
  bool is_looked_at() const { return looked_at_; }

 protected:
  /// It has come to the front: what was left out is shown now.
  virtual void look() = 0;

 private:
  bool looked_at_ = false;
};

}  // namespace loci::gui
