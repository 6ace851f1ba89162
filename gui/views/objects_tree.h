#pragma once

#include <QWidget>
#include <map>
#include <set>

#include "gui/data/browser.h"

class QLineEdit;
class QComboBox;
class QLabel;
class QGridLayout;
class QTreeView;

namespace loci::gui {

class ObjectsFilter;

class ObjectsModel;

/// The tree of places and objects with a search line.
class ObjectsTree : public QWidget {
  Q_OBJECT

 public:
  explicit ObjectsTree(Browser& browser, QWidget* parent = nullptr);

  QTreeView* view() const { return view_; }
  QLineEdit* search() const { return search_; }
  QComboBox* filter(int field) const { return filters_.at(field); }
  /// Nothing searched, nothing left out.
  void show_all();
  ObjectsModel* model() const { return model_; }
  /// Where an object is in the view's (filtered) model; invalid when it is not shown.
  QModelIndex shown_index_of_object(int64_t object) const;

 private:
  void build_search();
  void build_view();
  void find();
  void follow_selection();
  void take_selection();
  void restore_open_groups();
  void show_filtered();
  void add_filter(int field, const QString& all, const QString& tip, QGridLayout& layout);
  void fill_filter(int field);
  void count();

  Browser& browser_;
  ObjectsModel* model_;
  ObjectsFilter* filtered_;
  QLineEdit* search_;
  std::map<int, QComboBox*> filters_;  ///< by ObjectsFilter::Field
  QLabel* count_;
  QTreeView* view_;
  std::set<QString> closed_;  ///< groups that a person folded
  bool following_ = false;
};

}  // namespace loci::gui
