#pragma once

#include <QAbstractTableModel>
#include <vector>

#include "gui/browser.h"
#include "gui/data/memory_log.h"

namespace loci::gui {

/// What went wrong since the window was opened, then the runs and scenes of the memory.
class LogModel : public QAbstractTableModel {
  Q_OBJECT

 public:
  enum Column { time_column, what_column, text_column, column_count };

  explicit LogModel(Browser& browser, QObject* parent = nullptr);

  int rowCount(const QModelIndex& parent = {}) const override;
  int columnCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex& index, int role = Qt::DisplayRole) const override;
  QVariant headerData(int section, Qt::Orientation orientation, int role) const override;

  const LogEntry& entry(int row) const;
  /// An error of the window itself; it comes first.
  void add_problem(const QString& message);
  void set_memory_log(std::vector<LogEntry> entries);

 private:
  Browser& browser_;
  std::vector<LogEntry> problems_;  ///< oldest first
  std::vector<LogEntry> entries_;
};

}  // namespace loci::gui
