#pragma once

#include <QAbstractTableModel>
#include <optional>
#include <vector>

#include "gui/browser.h"

namespace loci::gui {

/// The history of the chosen object: since when, where, what happened, how sure. Newest first.
class HistoryModel : public QAbstractTableModel {
  Q_OBJECT

 public:
  enum Column { time_column, what_column, place_column, probability_column, column_count };
  enum Role { time_role = Qt::UserRole };  ///< qlonglong nanoseconds

  explicit HistoryModel(Browser& browser, QObject* parent = nullptr);

  int rowCount(const QModelIndex& parent = {}) const override;
  int columnCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex& index, int role = Qt::DisplayRole) const override;
  QVariant headerData(int section, Qt::Orientation orientation, int role) const override;

 private:
  void refresh();
  void set_entries(std::vector<HistoryEntry> entries);
  bool is_now(size_t row) const;

  Browser& browser_;
  std::optional<int64_t> object_;
  std::vector<HistoryEntry> entries_;
};

}  // namespace loci::gui
