#pragma once

#include <vector>

#include "gui/core/widgets.h"
#include "gui/data/browser.h"
#include "gui/models/table_models.h"
#include "gui/views/map/map_pair.h"

class QCheckBox;
class QLabel;
class QComboBox;
class QLineEdit;
class QTableView;

namespace loci::gui {

/// Two beliefs side by side: what appeared, moved and is gone between another time, what was known earlier of
/// a time, or another memory, and what is believed at the selected time. A click on a line selects its
/// object.
class CompareView : public Page {
  Q_OBJECT

 public:
  explicit CompareView(Browser& browser, QWidget* parent = nullptr);

  /// The time that the selected one is compared with.
  void set_other(TimeNs time);
  /// Another memory's end instead of a time of this one.
  void compare_with(const QString& path);
  QComboBox* source() const { return source_; }
  TimeNs other() const { return other_; }
  QLineEdit* stamp() const { return stamp_; }
  QTableView* table() const { return table_; }
  /// What it is compared with, for a map beside the map; of no memory when that is not wanted.
  OtherBelief beside() const;
  QCheckBox* beside_box() const { return beside_; }
  const std::vector<Difference>& shown() const { return model_->differences(); }

 Q_SIGNALS:
  /// The differences have changed, or whether both maps are shown.
  void compared();

 protected:
  void came_to_front() override { refresh(); }

 private:
  void forget();
  void fill_sources();
  void take_source(int index);
  void ask_for_memory();
  void read_other();
  void refresh();
  void take_stamp();
  void show_differences(const Belief& then);

  Browser& browser_;
  QLineEdit* stamp_;
  QComboBox* source_;
  QCheckBox* beside_;
  std::vector<std::pair<int64_t, int64_t>> same_;  ///< of another memory: number here, number there
  QLabel* state_;
  DifferencesModel* model_;
  QTableView* table_;
  TimeNs other_ = 0;
  std::optional<TimeNs> known_at_;             ///< as which the other time is believed; unset = as known now
  std::shared_ptr<const OpenMemory> another_;  ///< memory that the other time is of; null = the open one
  std::string memory_;                         ///< path of the memory that `other_` is a time of
};

}  // namespace loci::gui
