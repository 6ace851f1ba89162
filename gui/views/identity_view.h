#pragma once

#include <QWidget>
#include <optional>
#include <vector>

#include "gui/core/widgets.h"
#include "gui/data/browser.h"
#include "gui/data/decisions.h"

class QLabel;

namespace loci::gui {

/// The last scenes side by side with what was seen in them, and lines from each observation to the earlier
/// ones that it may be the same as: the darker, the more probable (Fig. 6.4 of the dissertation).
class AssociationLines : public QWidget {
  Q_OBJECT

 public:
  /// From an observation (scene, observation: indexes) to an earlier one.
  struct Line {
    size_t scene = 0, observation = 0, earlier_scene = 0, earlier_observation = 0;
    double probability = 0;
    bool chosen = false;
  };

  explicit AssociationLines(QWidget* parent = nullptr);

  /// In order of time; the last is the selected one.
  void set(std::vector<SceneDecisions> scenes, const TimeZone& zone);
  void select(std::optional<int64_t> object);
  const std::vector<Line>& lines() const { return lines_; }
  QSize sizeHint() const override;
  QSize minimumSizeHint() const override { return {240, sizeHint().height()}; }

 Q_SIGNALS:
  void object_clicked(qlonglong object);
  void scene_clicked(qlonglong time);

 protected:
  void paintEvent(QPaintEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;

 private:
  QRect tile(size_t scene, size_t observation) const;

  std::vector<SceneDecisions> scenes_;
  std::vector<Line> lines_;
  std::optional<int64_t> selected_;
  TimeZone zone_;
};

/// The identity decisions of a scene as three matrices (Fig. 6.9 of the dissertation): similarity,
/// proximity and identity. New observations along the top, believed objects along the left;
/// below "is": A something new, F a false cluster; beside it D gone, M missed, H hidden. The assignment
/// is red.
class DecisionMatrix : public QWidget {
  Q_OBJECT

 public:
  explicit DecisionMatrix(QWidget* parent = nullptr);

  void set(SceneDecisions decisions);
  const SceneDecisions& decisions() const { return decisions_; }
  QSize sizeHint() const override;
  QSize minimumSizeHint() const override { return {240, sizeHint().height()}; }
  /// Text at a point, for tooltips; empty = none.
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

class AssociationLines;
class DecisionMatrix;

/// How object identities were decided in the selected scene: lines to the scenes before, and the matrices of
/// similarity, proximity and identity.
class IdentityView : public Page {
  Q_OBJECT

 public:
  explicit IdentityView(Browser& browser, QWidget* parent = nullptr);

  QString state() const;
  AssociationLines& lines() { return *lines_; }
  DecisionMatrix& matrix() { return *matrix_; }

 protected:
  void came_to_front() override { refresh(); }

 private:
  void refresh();
  void show_decisions(std::vector<SceneDecisions>& scenes);

  Browser& browser_;
  QLabel* state_;
  AssociationLines* lines_;
  DecisionMatrix* matrix_;
};

}  // namespace loci::gui
