#include "gui/views/objects_tree.h"

#include <QComboBox>
#include <QGridLayout>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QTreeView>
#include <QVBoxLayout>
#include <functional>
#include <utility>

#include "gui/models/objects_model.h"

namespace loci::gui {
namespace {

/// Fills its list when it is opened.
class FilterBox : public QComboBox {
 public:
  FilterBox(std::function<void()> fill, QWidget* parent) : QComboBox(parent), fill_(std::move(fill)) {}
  void showPopup() override {
    fill_();
    QComboBox::showPopup();
  }

 private:
  std::function<void()> fill_;
};

}  // namespace

ObjectsTree::ObjectsTree(Browser& browser, QWidget* parent)
    : QWidget(parent),
      browser_(browser),
      model_(new ObjectsModel(browser, this)),
      filtered_(new ObjectsFilter(this)),
      search_(new QLineEdit(this)),
      count_(new QLabel(this)),
      view_(new QTreeView(this)) {
  filtered_->setSourceModel(model_);
  build_search();
  build_view();
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(6, 6, 6, 6);
  layout->setSpacing(6);
  layout->addWidget(search_);
  auto* filters = new QGridLayout;
  filters->setSpacing(4);
  add_filter(ObjectsFilter::class_field, "Any class", "Only objects of this class", *filters);
  add_filter(ObjectsFilter::color_field, "Any colour", "Only objects of this colour", *filters);
  add_filter(ObjectsFilter::state_field, "Any state",
             "Only objects that are seen, out of view, hidden, missed or gone", *filters);
  add_filter(ObjectsFilter::hour_field, "Any hour", "Only objects seen last in this hour of the day",
             *filters);
  layout->addLayout(filters);
  layout->addWidget(view_);
  layout->addWidget(count_);
  connect(filtered_, &QAbstractItemModel::modelReset, this, [this] {
    restore_open_groups();
    follow_selection();
    count();
  });
  connect(&browser_, &Browser::selected, this, &ObjectsTree::follow_selection);
  restore_open_groups();
}

void ObjectsTree::build_search() {
  search_->setPlaceholderText("Search name, colour, place, state");
  search_->setClearButtonEnabled(true);
  search_->setToolTip(
      "Shows only rows that contain this text (Ctrl+F). Enter selects what a description refers to, also by "
      "text on the object: milk, red cup, Ada's");
  connect(search_, &QLineEdit::returnPressed, this, &ObjectsTree::find);
  connect(search_, &QLineEdit::textChanged, this, [this](const QString& text) {
    following_ = true;  // The view moves on to a row that stays: no selection by a person.
    filtered_->search(text);
    show_filtered();
  });
}

void ObjectsTree::build_view() {
  view_->setModel(filtered_);
  view_->setUniformRowHeights(true);
  view_->setIndentation(12);
  view_->setIconSize({20, 20});
  view_->setAlternatingRowColors(false);
  view_->setEditTriggers(QAbstractItemView::NoEditTriggers);
  view_->header()->setStretchLastSection(false);
  view_->header()->setSectionResizeMode(ObjectsModel::name_column, QHeaderView::Stretch);
  view_->header()->setSectionResizeMode(ObjectsModel::state_column, QHeaderView::ResizeToContents);
  view_->header()->setSectionResizeMode(ObjectsModel::probability_column, QHeaderView::ResizeToContents);
  connect(view_, &QTreeView::collapsed, this, [this](const QModelIndex& index) {
    closed_.insert(index.data(ObjectsModel::group_role).toString());
  });
  connect(view_, &QTreeView::expanded, this, [this](const QModelIndex& index) {
    closed_.erase(index.data(ObjectsModel::group_role).toString());
  });
  connect(view_->selectionModel(), &QItemSelectionModel::selectionChanged, this,
          &ObjectsTree::take_selection);
}

/// Selects what the search text refers to.
void ObjectsTree::find() {
  browser_.reader().read<SearchResult>(
      this, "find", Urgency::moment,
      [text = search_->text().trimmed().toStdString(),
       time = browser_.selection().time()](const OpenMemory& memory) { return memory.find(text, time); },
      [this](const SearchResult& found) {
        if (found.objects.empty() && found.place.empty()) return;
        show_all();
        if (!found.objects.empty())
          browser_.selection().select_object(found.objects.front());
        else
          browser_.selection().select_place(found.place);
      });
}

void ObjectsTree::add_filter(int field, const QString& all, const QString& tip, QGridLayout& layout) {
  auto* box = new FilterBox([this, field] { fill_filter(field); }, this);
  box->addItem(all);
  box->setToolTip(tip);
  box->setFocusPolicy(Qt::NoFocus);
  box->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  box->setMinimumContentsLength(8);
  filters_[field] = box;
  layout.addWidget(box, field / 2, field % 2);
  connect(box, QOverload<int>::of(&QComboBox::activated), this, [this, box, field](int index) {
    following_ = true;
    filtered_->want(static_cast<ObjectsFilter::Field>(field), index == 0 ? QString() : box->currentText());
    show_filtered();
  });
}

/// The selected value stays in the list, even when no object has it at this time.
void ObjectsTree::fill_filter(int field) {
  QComboBox* box = filters_.at(field);
  QStringList values = filtered_->values(static_cast<ObjectsFilter::Field>(field));
  const QString chosen = box->currentIndex() > 0 ? box->currentText() : QString();
  if (!chosen.isEmpty() && !values.contains(chosen)) values << chosen;
  values.prepend(box->itemText(0));
  box->clear();
  box->addItems(values);
  box->setCurrentIndex(chosen.isEmpty() ? 0 : values.indexOf(chosen));
}

void ObjectsTree::count() {
  int shown = 0, all = 0;
  for (int row = 0; row < filtered_->rowCount(); ++row)
    shown += filtered_->rowCount(filtered_->index(row, 0));
  for (int row = 0; row < model_->rowCount(); ++row) all += model_->rowCount(model_->index(row, 0));
  count_->setText(shown == all ? QString("%1 object%2").arg(all).arg(all == 1 ? "" : "s")
                               : QString("%1 of %2 objects").arg(shown).arg(all));
}

void ObjectsTree::show_filtered() {
  for (int row = 0; row < filtered_->rowCount(); ++row) view_->setFirstColumnSpanned(row, {}, true);
  view_->expandAll();
  follow_selection();
  count();
}

void ObjectsTree::show_all() {
  search_->clear();
  for (const auto& [field, box] : filters_) {
    box->setCurrentIndex(0);
    filtered_->want(static_cast<ObjectsFilter::Field>(field), {});
  }
  show_filtered();
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

void ObjectsTree::take_selection() {
  if (following_) return;
  const QModelIndexList rows = view_->selectionModel()->selectedRows();
  if (rows.isEmpty()) return;  // A filter or another time hid it: it stays selected.
  const QVariant object = rows.front().data(ObjectsModel::object_role);
  if (object.isValid())
    browser_.selection().select_object(object.toLongLong());
  else
    browser_.selection().select_place(rows.front().data(ObjectsModel::place_role).toString().toStdString());
}

}  // namespace loci::gui
