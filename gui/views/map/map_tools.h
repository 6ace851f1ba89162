#pragma once

#include <QString>
#include <string>
#include <vector>

#include "gui/core/widgets.h"
#include "gui/data/browser.h"

class QCheckBox;
class QComboBox;
class QLabel;
class QScrollArea;
class QSlider;
class QToolButton;
class QVBoxLayout;

namespace loci::gui {

class MapView;

/// What one does to the map to see more of it: measuring, cutting it open, opening its doors and drawers.
/// Nothing of it is written; joints go back to what is believed when another time is selected.
class MapTools : public Page {
  Q_OBJECT

 public:
  MapTools(Browser& browser, MapView& map, QWidget* parent = nullptr);

  QToolButton* ruler() const { return ruler_; }
  QLabel* measured() const { return measured_; }
  QComboBox* section() const { return section_; }
  QSlider* section_at() const { return section_at_; }
  /// Of a joint of the map; nullptr when it cannot be moved.
  QSlider* slider(const std::string& joint) const;

 protected:
  void came_to_front() override { refresh(); }

 private:
  struct JointRow {
    std::string name;
    double lower = 0, upper = 0;
    bool turns = false;
    QSlider* slider = nullptr;
    QLabel* value = nullptr;
  };
  void build_measuring(QVBoxLayout& layout);
  void build_section(QVBoxLayout& layout);
  void build_joints(QVBoxLayout& layout);
  void refresh();
  void fill_joints(const mapping::World* world);
  void show_values();
  void take_joints();
  void take_section();

  Browser& browser_;
  MapView& map_;
  QToolButton* ruler_;
  QLabel* measured_;
  QComboBox* section_;
  QSlider* section_at_;
  QLabel* section_text_;
  QCheckBox* section_above_;
  QScrollArea* area_;
  QToolButton* put_back_;
  QLabel* empty_;
  std::vector<JointRow> rows_;
  std::shared_ptr<const OpenMemory> filled_;  ///< whose joints are listed
  bool listed_ = false;
};

}  // namespace loci::gui
