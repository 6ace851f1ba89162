#pragma once

#include <QSortFilterProxyModel>
#include <array>

namespace loci::gui {

/// What of the tree is shown: rows that contain the searched words, and are of the chosen class, colour,
/// state and hour. An empty wish is none.
class ObjectsFilter : public QSortFilterProxyModel {
  Q_OBJECT

 public:
  enum Field { class_field, color_field, state_field, hour_field, field_count };

  explicit ObjectsFilter(QObject* parent = nullptr);

  void search(const QString& text);
  void want(Field field, const QString& value);
  /// Whether anything is left out.
  bool filters() const;
  /// What the rows of the source say of a field, sorted.
  QStringList values(Field field) const;

 protected:
  bool filterAcceptsRow(int row, const QModelIndex& parent) const override;

 private:
  QString text_;
  std::array<QString, field_count> wanted_;
};

}  // namespace loci::gui
