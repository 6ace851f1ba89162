#pragma once

#include <QColor>
#include <QIcon>
#include <QTimer>
#include <QWidget>
#include <utility>
#include <vector>

#include "gui/data/browser.h"
#include "gui/views/timeline/time_track.h"

class QComboBox;
class QHBoxLayout;
class QLabel;
class QLineEdit;
class QToolButton;

namespace loci::gui {

enum class Transport { first, previous, play, pause, next, last };

class LaneView;
class TimeTrack;

/// The selected time: buttons, a time stamp that can be edited, the slider, what happened there in words, and
/// the lanes of objects and places.
class TimeBar : public QWidget {
  Q_OBJECT

 public:
  explicit TimeBar(Browser& browser, QWidget* parent = nullptr);

  void take_focus();
  TimeTrack* track() const { return track_; }
  LaneView* lanes() const { return lanes_; }
  TimeAxis& axis() { return axis_; }
  QLineEdit* stamp() const { return stamp_; }
  /// Which scene is shown, and how far it is from the selected time.
  QString scene_text() const;
  /// Transaction time: as known now, or before one of the runs.
  QComboBox* known() const { return known_; }
  bool plays() const { return timer_.isActive(); }
  /// Starts at the beginning when the end is reached; stops there.
  void toggle_play();

 protected:
  void changeEvent(QEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;

 private:
  void add_buttons(QHBoxLayout& line);
  void add_stamp(QHBoxLayout& line);
  void add_known(QHBoxLayout& line);
  void take_memory();
  void refresh();
  void take_stamp();
  void fill_known();
  void play_step();
  QString legend() const;
  void paint_buttons();
  void elide();
  QString what_happened() const;

  Browser& browser_;
  TimeAxis axis_;
  TimeTrack* track_;
  LaneView* lanes_;
  QLineEdit* stamp_;
  QLabel* zone_;
  QLabel* scene_;
  QLabel* happened_;
  QLabel* legend_;
  QComboBox* known_;
  std::vector<std::pair<Transport, QToolButton*>> buttons_;
  QTimer timer_;
  std::string memory_;  ///< path of the memory that the axis is of
};

}  // namespace loci::gui
