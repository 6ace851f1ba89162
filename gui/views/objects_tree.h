#pragma once

#include <QWidget>
#include <set>

#include "gui/browser.h"

class QLineEdit;
class QSortFilterProxyModel;
class QTreeView;

namespace loci {

class ObjectsModel;

/// The tree of places and objects with a search line.
class ObjectsTree : public QWidget {
  Q_OBJECT

 public:
  explicit ObjectsTree(Browser& browser, QWidget* parent = nullptr);

  QTreeView* view() const { return view_; }
  QLineEdit* search() const { return search_; }
  ObjectsModel* model() const { return model_; }
  /// Where an object is in the view's (filtered) model; invalid when it is not shown.
  QModelIndex shown_index_of_object(int64_t object) const;

 private:
  void follow_selection();
  void tell_selection();
  void restore_open_groups();

  Browser& browser_;
  ObjectsModel* model_;
  QSortFilterProxyModel* filtered_;
  QLineEdit* search_;
  QTreeView* view_;
  std::set<QString> closed_;  ///< groups that a person folded
  bool following_ = false;
};

}  // namespace loci
