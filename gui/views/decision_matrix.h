#pragma once

#include <QWidget>
#include <vector>

#include "gui/data/decisions.h"

namespace loci::gui {

/// The identity decisions of a scene as three matrices (Fig. 6.9 of the dissertation): how alike things look,
/// how near they are, and what is the same. New observations along the top, believed objects along the left;
/// below "is": A something new, F a false cluster; beside it D gone, M missed, H hidden. What was chosen is
/// red.
class DecisionMatrix : public QWidget {
  Q_OBJECT

 public:
  explicit DecisionMatrix(QWidget* parent = nullptr);

  void set(SceneDecisions decisions);
  const SceneDecisions& decisions() const { return decisions_; }
  QSize sizeHint() const override;
  QSize minimumSizeHint() const override { return {240, sizeHint().height()}; }
  /// What a point says, for tooltips; empty = nothing.
  QString text_at(const QPoint& point) const;

 Q_SIGNALS:
  void object_clicked(qlonglong object);

 protected:
  void paintEvent(QPaintEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  bool event(QEvent* event) override;

 private:
  enum class Panel { alike, near, is };
  /// A believed object that was considered or missed: a row.
  struct Row {
    int64_t key = 0, object = 0;
    QString name;
  };
  struct Cell {
    Panel panel = Panel::is;
    int row = -1, column = -1;  ///< -1 = the heading
  };
  int cell_size() const;
  int panel_height(Panel panel) const;
  int panel_top(Panel panel) const;
  std::optional<Cell> cell_at(const QPoint& point) const;
  const ConsideredObject* considered(size_t row, size_t column) const;
  double value(Panel panel, size_t row, size_t column) const;  ///< 0 to 1; negative = not considered
  void paint_panel(QPainter& painter, Panel panel) const;

  SceneDecisions decisions_;
  std::vector<Row> rows_;
};

}  // namespace loci::gui
