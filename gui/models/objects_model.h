#pragma once

#include <QAbstractItemModel>
#include <QObject>
#include <QPixmap>
#include <QSortFilterProxyModel>
#include <array>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "gui/data/browser.h"

namespace loci::gui {

/// The objects' newest images, small; read when they are first asked for.
class Thumbnails : public QObject {
  Q_OBJECT

 public:
  Thumbnails(Browser& browser, int side, QObject* parent = nullptr);

  /// Null while it is read, and when there is none.
  QPixmap of(int64_t object);

 Q_SIGNALS:
  void read(qlonglong object);

 private:
  void forget();

  Browser& browser_;
  int side_;
  std::string memory_;
  std::map<int64_t, QPixmap> images_;
  std::set<int64_t> asked_;
};

/// Places with the objects believed to be at them at the selected time; what is gone comes last, in a group
/// of its own.
class ObjectsModel : public QAbstractItemModel {
  Q_OBJECT

 public:
  enum Column { name_column, state_column, probability_column, column_count };
  enum Role {
    object_role = Qt::UserRole,  ///< int64 id, invalid for a group
    place_role,                  ///< QString, of groups that are places
    group_role,                  ///< QString, of every group: stable over time
    filter_role,                 ///< all words that a search looks in
    class_role,                  ///< of objects, for the filters
    color_role,
    state_role,
    hour_role  ///< of the day at which it was seen last: "08:00"
  };

  explicit ObjectsModel(Browser& browser, QObject* parent = nullptr);

  QModelIndex index(int row, int column, const QModelIndex& parent = {}) const override;
  QModelIndex parent(const QModelIndex& child) const override;
  int rowCount(const QModelIndex& parent = {}) const override;
  int columnCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex& index, int role = Qt::DisplayRole) const override;
  QVariant headerData(int section, Qt::Orientation orientation, int role) const override;

  QModelIndex index_of_object(int64_t object) const;
  QModelIndex index_of_place(const std::string& place) const;

 private:
  struct Group {
    QString title;
    std::string place;  ///< empty for "gone" and "somewhere"
    std::vector<BelievedObject> objects;
  };

  void refresh();
  static std::vector<Group> groups_of(const Belief& belief);
  bool same_shape(const std::vector<Group>& groups) const;
  QVariant group_data(const Group& group, int column, int role) const;
  QVariant object_data(const BelievedObject& object, int column, int role) const;

  Browser& browser_;
  Thumbnails* thumbnails_;
  std::vector<Group> groups_;
};

/// What of the tree is shown: rows that contain the searched words, and have the wanted class, colour,
/// state and hour; empty = any.
class ObjectsFilter : public QSortFilterProxyModel {
  Q_OBJECT

 public:
  enum Field { class_field, color_field, state_field, hour_field, field_count };

  explicit ObjectsFilter(QObject* parent = nullptr);

  void search(const QString& text);
  void want(Field field, const QString& value);
  /// Whether anything is left out.
  bool filters() const;
  /// The values of a field in the rows of the source, sorted.
  QStringList values(Field field) const;

 protected:
  bool filterAcceptsRow(int row, const QModelIndex& parent) const override;

 private:
  QString text_;
  std::array<QString, field_count> wanted_;
};

}  // namespace loci::gui
