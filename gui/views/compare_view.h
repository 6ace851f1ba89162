#pragma once

#include <vector>

#include "gui/browser.h"
#include "gui/models/differences_model.h"
#include "gui/views/page.h"

class QLabel;
class QLineEdit;
class QTableView;

namespace loci {

/// Two times of the memory side by side: what appeared, moved and is gone between another time and the chosen
/// one. A click on a line chooses its object.
class CompareView : public Page {
  Q_OBJECT

 public:
  explicit CompareView(Browser& browser, QWidget* parent = nullptr);

  /// The time that the chosen one is compared with.
  void set_other(TimeNs time);
  TimeNs other() const { return other_; }
  QLineEdit* stamp() const { return stamp_; }
  QTableView* table() const { return table_; }
  const std::vector<Difference>& shown() const { return model_->differences(); }

 protected:
  void look() override { refresh(); }

 private:
  void forget();
  void refresh();
  void take_stamp();
  void show_differences(const BelievedScene& then);

  Browser& browser_;
  QLineEdit* stamp_;
  QLabel* state_;
  DifferencesModel* model_;
  QTableView* table_;
  TimeNs other_ = 0;
  std::string memory_;  ///< path of the memory that `other_` is a time of
};

}  // namespace loci
