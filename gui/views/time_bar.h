#pragma once

#include <QTimer>
#include <QWidget>
#include <utility>
#include <vector>

#include "gui/browser.h"
#include "gui/transport_icon.h"

class QLabel;
class QLineEdit;
class QToolButton;

namespace loci {

class TimeTrack;

/// The chosen time: buttons, a time stamp that can be edited, the slider, and what happened there in words.
class TimeBar : public QWidget {
  Q_OBJECT

 public:
  explicit TimeBar(Browser& browser, QWidget* parent = nullptr);

  TimeTrack* track() const { return track_; }
  QLineEdit* stamp() const { return stamp_; }
  bool plays() const { return timer_.isActive(); }
  /// Starts at the beginning when the end is reached; stops there.
  void toggle_play();

 Q_SIGNALS:
  void play_changed(bool plays);

 protected:
  void changeEvent(QEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;

 private:
  void refresh();
  void take_stamp();
  void play_step();
  void paint_buttons();
  void elide();
  QString what_happened() const;

  Browser& browser_;
  TimeTrack* track_;
  QLineEdit* stamp_;
  QLabel* zone_;
  QLabel* scene_;
  QLabel* happened_;
  std::vector<std::pair<Transport, QToolButton*>> buttons_;
  QTimer timer_;
};

}  // namespace loci
