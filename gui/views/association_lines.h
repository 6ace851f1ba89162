#pragma once

#include <QWidget>
#include <optional>
#include <vector>

#include "gui/data/decisions.h"

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

  /// In the order of time; the last is the chosen one.
  void set(std::vector<SceneDecisions> scenes, int zone_minutes);
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
  int zone_minutes_ = 0;
};

}  // namespace loci::gui
