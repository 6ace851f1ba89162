#include "gui/views/objects_tree.h"

#include <QHeaderView>
#include <QLineEdit>
#include <QSortFilterProxyModel>
#include <QTreeView>
#include <QVBoxLayout>

#include "gui/models/objects_model.h"

namespace loci {

ObjectsTree::ObjectsTree(Browser& browser, QWidget* parent)
    : QWidget(parent),
      browser_(browser),
      model_(new ObjectsModel(browser, this)),
      filtered_(new QSortFilterProxyModel(this)),
      search_(new QLineEdit(this)),
      view_(new QTreeView(this)) {
  filtered_->setSourceModel(model_);
  filtered_->setRecursiveFilteringEnabled(true);
  filtered_->setFilterRole(ObjectsModel::filter_role);
  filtered_->setFilterCaseSensitivity(Qt::CaseInsensitive);
  search_->setPlaceholderText("Search name, colour, place, state");
  search_->setClearButtonEnabled(true);
  search_->setToolTip("Shows only what contains this text (Ctrl+F)");
  view_->setModel(filtered_);
  view_->setUniformRowHeights(true);
  view_->setIndentation(14);
  view_->setAlternatingRowColors(false);
  view_->setEditTriggers(QAbstractItemView::NoEditTriggers);
  view_->header()->setStretchLastSection(false);
  view_->header()->setSectionResizeMode(ObjectsModel::name_column, QHeaderView::Stretch);
  view_->header()->setSectionResizeMode(ObjectsModel::state_column, QHeaderView::ResizeToContents);
  view_->header()->setSectionResizeMode(ObjectsModel::probability_column, QHeaderView::ResizeToContents);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(6, 6, 6, 6);
  layout->setSpacing(6);
  layout->addWidget(search_);
  layout->addWidget(view_);

  connect(search_, &QLineEdit::textChanged, this, [this](const QString& text) {
    following_ = true;  // The view moves on to a row that stays; nobody chose it.
    filtered_->setFilterFixedString(text);
    for (int row = 0; row < filtered_->rowCount(); ++row) view_->setFirstColumnSpanned(row, {}, true);
    view_->expandAll();
    follow_selection();
  });
  connect(view_, &QTreeView::collapsed, this, [this](const QModelIndex& index) {
    closed_.insert(index.data(ObjectsModel::group_role).toString());
  });
  connect(view_, &QTreeView::expanded, this, [this](const QModelIndex& index) {
    closed_.erase(index.data(ObjectsModel::group_role).toString());
  });
  connect(filtered_, &QAbstractItemModel::modelReset, this, [this] {
    restore_open_groups();
    follow_selection();
  });
  connect(view_->selectionModel(), &QItemSelectionModel::selectionChanged, this,
          &ObjectsTree::tell_selection);
  connect(&browser_, &Browser::selected, this, &ObjectsTree::follow_selection);
  restore_open_groups();
}

void ObjectsTree::restore_open_groups() {
  for (int row = 0; row < filtered_->rowCount(); ++row) {
    const QModelIndex index = filtered_->index(row, 0);
    view_->setFirstColumnSpanned(row, {}, true);
    view_->setExpanded(index, !closed_.contains(index.data(ObjectsModel::group_role).toString()));
  }
}

QModelIndex ObjectsTree::shown_index_of_object(int64_t object) const {
  return filtered_->mapFromSource(model_->index_of_object(object));
}

void ObjectsTree::follow_selection() {
  following_ = true;
  const SelectionModel& selection = browser_.selection();
  const QModelIndex index = selection.object()
                                ? shown_index_of_object(*selection.object())
                                : filtered_->mapFromSource(model_->index_of_place(selection.place()));
  if (index.isValid()) {
    view_->selectionModel()->setCurrentIndex(index,
                                             QItemSelectionModel::ClearAndSelect | QItemSelectionModel::Rows);
    view_->scrollTo(index);
  } else {
    view_->selectionModel()->clear();
  }
  following_ = false;
}

void ObjectsTree::tell_selection() {
  if (following_) return;
  const QModelIndexList rows = view_->selectionModel()->selectedRows();
  if (rows.isEmpty()) return;  // A filter or another time hid it: it stays chosen.
  const QVariant object = rows.front().data(ObjectsModel::object_role);
  if (object.isValid())
    browser_.selection().select_object(object.toLongLong());
  else
    browser_.selection().select_place(rows.front().data(ObjectsModel::place_role).toString().toStdString());
}

}  // namespace loci
