#pragma once

#include "gui/core/widgets.h"
#include "gui/data/browser.h"

class QPlainTextEdit;
class QTableView;
class QToolButton;

namespace loci::gui {

class LogModel;

/// What went wrong, and which runs wrote which scenes; a click on a scene goes to its time. The details of a
/// line stand below and can be copied.
class LogView : public Page {
  Q_OBJECT

 public:
  explicit LogView(Browser& browser, QWidget* parent = nullptr);

  LogModel& model() { return *model_; }
  QTableView* table() const { return table_; }
  /// The selected line's details to the clipboard.
  void copy_details();

 protected:
  void came_to_front() override;

 private:
  void forget();
  void load();
  void show_details();
  /// To the line of the selected scene, when that is another one.
  void follow_scene();

  Browser& browser_;
  LogModel* model_;
  QTableView* table_;
  QPlainTextEdit* details_;
  QToolButton* copy_;
  bool loaded_ = false;
  TimeNs followed_ = 0;  ///< the scene that was gone to last
};

}  // namespace loci::gui
