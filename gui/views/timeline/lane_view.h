#pragma once

#include <QAbstractScrollArea>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "gui/core/widgets.h"
#include "gui/data/browser.h"
#include "gui/views/timeline/time_track.h"

namespace loci::gui {

/// A lane per object and place below the time track, in three colours: seen, missed, not
/// observed; events as dots. A click chooses the time and the object or place, a drag scrubs. Only lanes
/// that are on the screen are read from the memory.
class LaneView : public QAbstractScrollArea {
  Q_OBJECT

 public:
  LaneView(Browser& browser, TimeAxis& axis, QWidget* parent = nullptr);

  struct Lane {
    int64_t object = 0;      ///< 0 = a place
    std::string place = {};  ///< empty = an object
    QString name = {};
  };
  const std::vector<Lane>& lanes() const { return lanes_; }
  /// The middle of a lane at a time, on the viewport.
  QPoint point_of(size_t lane, TimeNs time) const;
  QSize sizeHint() const override { return {600, 110}; }
  QSize minimumSizeHint() const override { return {200, 78}; }

 protected:
  void paintEvent(QPaintEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;
  void scrollContentsBy(int dx, int dy) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void wheelEvent(QWheelEvent* event) override;
  bool viewportEvent(QEvent* event) override;

 private:
  void reload();
  void refresh();
  void follow_selection();
  void update_scroll_bar();
  int top_of(size_t lane) const;
  const Lane* lane_at(int y) const;
  bool is_selected(const Lane& lane) const;
  void set_time_at(double x);
  using Key = std::pair<int64_t, std::string>;
  void show_lanes(const Belief& belief);
  /// What is known of a lane; what is missing is asked for.
  const std::vector<memory::ObjectStatus>& visibility(const Lane& lane);
  /// What was asked for and has been scrolled away is not read any more.
  void forget_hidden();
  bool goes_on_from(const OpenMemory& memory) const;
  void paint_lanes(QPainter& painter);
  void paint_lane(QPainter& painter, const Lane& lane, int top, const std::vector<double>& scene_x);
  void paint_visibility(QPainter& painter, const Lane& lane, double top, const std::vector<double>& scene_x);

  Browser& browser_;
  Backdrop backdrop_;  ///< all but the selected time
  TimeAxis& axis_;
  std::vector<Lane> lanes_;
  std::map<int64_t, std::vector<const memory::Change*>> events_;  ///< by object
  std::map<Key, std::vector<memory::ObjectStatus>>
      shown_;            ///< that have been on the screen; may lack the newest scenes
  std::set<Key> asked_;  ///< that are being read
  std::string memory_;   ///< path of the memory that they are of
  size_t runs_ = 0;      ///< of it then
};

}  // namespace loci::gui
