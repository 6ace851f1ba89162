#pragma once

#include <QAbstractTableModel>
#include <vector>

#include "gui/data/differences.h"

namespace loci::gui {

/// Differences as lines of a table.
class DifferencesModel : public QAbstractTableModel {
  Q_OBJECT

 public:
  enum Column { what_column, name_column, then_column, now_column, column_count };

  using QAbstractTableModel::QAbstractTableModel;

  void set(std::vector<Difference> differences, const QString& then, const QString& now);
  const std::vector<Difference>& differences() const { return differences_; }

  int rowCount(const QModelIndex& parent = {}) const override;
  int columnCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex& index, int role = Qt::DisplayRole) const override;
  QVariant headerData(int section, Qt::Orientation orientation, int role) const override;

 private:
  std::vector<Difference> differences_;
  QString then_ = "Then", now_ = "Now";
};

}  // namespace loci::gui
