#include "gui/models/objects_filter.h"

#include <set>

#include "gui/models/objects_model.h"

namespace loci::gui {
namespace {

int role_of(ObjectsFilter::Field field) {
  switch (field) {
    case ObjectsFilter::class_field:
      return ObjectsModel::class_role;
    case ObjectsFilter::color_field:
      return ObjectsModel::color_role;
    case ObjectsFilter::state_field:
      return ObjectsModel::state_role;
    default:
      return ObjectsModel::hour_role;
  }
}

}  // namespace

ObjectsFilter::ObjectsFilter(QObject* parent) : QSortFilterProxyModel(parent) {
  setRecursiveFilteringEnabled(true);
}

void ObjectsFilter::search(const QString& text) {
  text_ = text;
  invalidateFilter();
}

void ObjectsFilter::want(Field field, const QString& value) {
  wanted_[field] = value;
  invalidateFilter();
}

bool ObjectsFilter::filters() const {
  bool any = !text_.isEmpty();
  for (const QString& value : wanted_) any |= !value.isEmpty();
  return any;
}

QStringList ObjectsFilter::values(Field field) const {
  std::set<QString> found;
  const QAbstractItemModel* model = sourceModel();
  for (int group = 0; group < model->rowCount(); ++group) {
    const QModelIndex parent = model->index(group, 0);
    for (int row = 0; row < model->rowCount(parent); ++row)
      found.insert(model->index(row, 0, parent).data(role_of(field)).toString());
  }
  found.erase(QString());
  return {found.begin(), found.end()};
}

bool ObjectsFilter::filterAcceptsRow(int row, const QModelIndex& parent) const {
  if (!filters()) return true;
  const QModelIndex index = sourceModel()->index(row, 0, parent);
  if (!index.data(ObjectsModel::filter_role).toString().contains(text_, Qt::CaseInsensitive)) return false;
  for (const Field field : {class_field, color_field, state_field, hour_field})
    if (!wanted_[field].isEmpty() && index.data(role_of(field)).toString() != wanted_[field]) return false;
  return true;
}

}  // namespace loci::gui
