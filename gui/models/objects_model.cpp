#include "gui/models/objects_model.h"

#include <QApplication>
#include <QFont>
#include <algorithm>
#include <map>
#include <set>

#include "gui/core/text.h"
#include "gui/core/theme.h"
#include "mapping/base/text/natural_order.h"
#include "memory/questions/replies/answer_format.h"

namespace loci::gui {

Thumbnails::Thumbnails(Browser& browser, int side, QObject* parent)
    : QObject(parent), browser_(browser), side_(side) {
  connect(&browser_, &Browser::opened, this, &Thumbnails::forget);
}

void Thumbnails::forget() {
  asked_.clear();  // what is being read is not delivered any more
  for (const auto& [object, image] : images_) asked_.insert(object);
  const std::string path = browser_.data() == nullptr ? "" : browser_.data()->info().path;
  if (path == memory_) return;  // it has grown: the images still show what they are of
  memory_ = path;
  images_.clear();
  asked_.clear();
}

QPixmap Thumbnails::of(int64_t object) {
  const auto known = images_.find(object);
  if (known != images_.end()) return known->second;
  if (asked_.insert(object).second)
    browser_.reader().read<QImage>(
        this, "thumbnail " + std::to_string(object), Urgency::rest,
        [object, side = side_, time = browser_.selection().time()](const OpenMemory& memory) {
          const QImage image = image_of(memory.image(object, time));
          return image.isNull() ? image
                                : image.scaled(side, side, Qt::KeepAspectRatio, Qt::SmoothTransformation);
        },
        [this, object](const QImage& image) {
          if (!image.isNull()) images_[object] = QPixmap::fromImage(image);
          Q_EMIT read(object);
        });
  return {};
}

namespace {

constexpr int kSwatchSide = 14, kImageSide = 20;
constexpr int kRowHeight = kImageSide + 2;
/// Internal id of groups; an object's index carries its group's row.
constexpr quintptr kGroupId = static_cast<quintptr>(-1);

}  // namespace

ObjectsModel::ObjectsModel(Browser& browser, QObject* parent)
    : QAbstractItemModel(parent), browser_(browser), thumbnails_(new Thumbnails(browser, kImageSide, this)) {
  connect(thumbnails_, &Thumbnails::read, this, [this](qlonglong object) {
    const QModelIndex index = index_of_object(object);
    if (index.isValid()) Q_EMIT dataChanged(index, index, {Qt::DecorationRole});
  });
  connect(&browser_, &Browser::belief_changed, this, &ObjectsModel::refresh);
  refresh();
}

std::vector<ObjectsModel::Group> ObjectsModel::groups_of(const Belief& belief) {
  std::map<std::string, Group, NaturalOrder> places;
  Group somewhere{"somewhere", "", {}};
  Group gone{"gone", "", {}};
  for (const BelievedObject& object : belief.objects) {
    const std::string place = belief.place_of(object);
    if (object.status == memory::ObjectStatus::gone) {
      gone.objects.push_back(object);
    } else if (place.empty()) {
      somewhere.objects.push_back(object);
    } else {
      Group& group = places[place];
      group.title = QString::fromStdString(place);
      group.place = place;
      group.objects.push_back(object);
    }
  }
  std::vector<Group> groups;
  for (auto& [name, group] : places) groups.push_back(std::move(group));
  for (Group* last : {&somewhere, &gone})
    if (!last->objects.empty()) groups.push_back(std::move(*last));
  return groups;
}

bool ObjectsModel::same_shape(const std::vector<Group>& groups) const {
  return std::equal(
      groups.begin(), groups.end(), groups_.begin(), groups_.end(), [](const Group& a, const Group& b) {
        return a.title == b.title &&
               std::equal(a.objects.begin(), a.objects.end(), b.objects.begin(), b.objects.end(),
                          [](const auto& x, const auto& y) { return x.object == y.object; });
      });
}

void ObjectsModel::refresh() {
  auto groups = groups_of(browser_.belief());
  if (same_shape(groups)) {  // Views keep what is open and where they are.
    groups_ = std::move(groups);
    for (int row = 0; row < rowCount(); ++row) {
      const QModelIndex group = index(row, 0);
      Q_EMIT dataChanged(index(0, 0, group), index(rowCount(group) - 1, column_count - 1, group));
    }
    return;
  }
  beginResetModel();
  groups_ = std::move(groups);
  endResetModel();
}

QModelIndex ObjectsModel::index(int row, int column, const QModelIndex& parent) const {
  if (!hasIndex(row, column, parent)) return {};
  return createIndex(row, column, parent.isValid() ? static_cast<quintptr>(parent.row()) : kGroupId);
}

QModelIndex ObjectsModel::parent(const QModelIndex& child) const {
  if (!child.isValid() || child.internalId() == kGroupId) return {};
  return createIndex(static_cast<int>(child.internalId()), 0, kGroupId);
}

int ObjectsModel::rowCount(const QModelIndex& parent) const {
  if (!parent.isValid()) return static_cast<int>(groups_.size());
  if (parent.internalId() != kGroupId || parent.column() != 0) return 0;
  return static_cast<int>(groups_[static_cast<size_t>(parent.row())].objects.size());
}

int ObjectsModel::columnCount(const QModelIndex&) const {
  return column_count;
}

QVariant ObjectsModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid()) return {};
  if (index.internalId() == kGroupId)
    return group_data(groups_[static_cast<size_t>(index.row())], index.column(), role);
  const Group& group = groups_[index.internalId()];
  return object_data(group.objects[static_cast<size_t>(index.row())], index.column(), role);
}

QVariant ObjectsModel::group_data(const Group& group, int column, int role) const {
  switch (role) {
    case Qt::SizeHintRole:
      return QSize(0, kRowHeight);
    case Qt::DisplayRole:
      return column == name_column ? QString("%1  (%2)").arg(group.title).arg(group.objects.size())
                                   : QVariant();
    case Qt::FontRole:
      return bold_font(QApplication::font());
    case Qt::ForegroundRole:
      if (column == state_column) return Theme::of(QApplication::palette()).muted;
      return {};
    case place_role:
      return group.place.empty() ? QVariant() : QString::fromStdString(group.place);
    case group_role:
    case filter_role:
      return group.title;
    default:
      return {};
  }
}

QVariant ObjectsModel::object_data(const BelievedObject& object, int column, int role) const {
  const Theme theme = Theme::of(QApplication::palette());
  const Belief& belief = browser_.belief();
  const QString color = QString::fromStdString(object.color.value_or(""));
  const auto class_name = [&] { return QString::fromStdString(belief.names->class_of(object.object)); };
  switch (role) {
    case Qt::DisplayRole:
      if (column == name_column) return QString::fromStdString(belief.name_of(object));
      return column == state_column ? state_text(object.status) : percent_text(object.probability);
    case Qt::TextAlignmentRole:
      return column == probability_column ? QVariant(Qt::AlignRight | Qt::AlignVCenter) : QVariant();
    case Qt::DecorationRole: {
      if (column != name_column) return {};
      const QPixmap image = thumbnails_->of(object.object);
      return centred(image.isNull() ? swatch(rgb_of(object), kSwatchSide) : image, kImageSide);
    }
    case Qt::ForegroundRole:
      if (column == state_column) return theme.of_status(object.status);
      return object.status == memory::ObjectStatus::seen ? QVariant() : QVariant(theme.muted);
    case Qt::ToolTipRole:
      return QString("%1 %2\n%3")
          .arg(color, class_name())
          .trimmed()
          .arg(object.size ? QString::fromStdString(memory::format::size_text(*object.size))
                           : "size unknown");
    case object_role:
      return static_cast<qlonglong>(object.object);
    case class_role:
      return class_name();
    case color_role:
      return color;
    case state_role:
      return state_text(object.status);
    case hour_role:
      return object.last_seen && browser_.data() != nullptr
                 ? time_text(*object.last_seen, browser_.data()->info().zone).mid(11, 2) + ":00"
                 : QString();
    case filter_role:
      return QStringList{QString::fromStdString(belief.name_of(object)), class_name(), color,
                         QString::fromStdString(belief.place_of(object)), state_text(object.status)}
          .join(' ');
    default:
      return {};
  }
}

QVariant ObjectsModel::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation == Qt::Horizontal && role == Qt::ToolTipRole)
    return section == probability_column ? "How probable it is that the object is there"
           : section == state_column     ? kStatusHelp
                                         : "Places with the objects that are believed to be there";
  if (orientation != Qt::Horizontal || role != Qt::DisplayRole) return {};
  switch (section) {
    case name_column:
      return "Place, object";
    case state_column:
      return "State";
    default:
      return "There";
  }
}

QModelIndex ObjectsModel::index_of_object(int64_t object) const {
  for (size_t g = 0; g < groups_.size(); ++g)
    for (size_t i = 0; i < groups_[g].objects.size(); ++i)
      if (groups_[g].objects[i].object == object)
        return index(static_cast<int>(i), 0, index(static_cast<int>(g), 0));
  return {};
}

QModelIndex ObjectsModel::index_of_place(const std::string& place) const {
  for (size_t g = 0; g < groups_.size(); ++g)
    if (!place.empty() && groups_[g].place == place) return index(static_cast<int>(g), 0);
  return {};
}

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
