#pragma once

#include <QWidget>

#include "memory/report/memory_statistics.h"

namespace loci::gui {

/// A chart with its title: lying bars with names and values beside them, or standing ones where the names are
/// short and many (hours).
class BarChart : public QWidget {
 public:
  explicit BarChart(memory::Chart chart, QWidget* parent = nullptr);

  QSize sizeHint() const override;
  QSize minimumSizeHint() const override;
  const memory::Chart& chart() const { return chart_; }

 protected:
  void paintEvent(QPaintEvent* event) override;

 private:
  bool stands() const;
  void paint_lying(QPainter& painter, double greatest) const;
  void paint_standing(QPainter& painter, double greatest) const;

  memory::Chart chart_;
};

}  // namespace loci::gui
