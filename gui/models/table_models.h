#pragma once

#include <QAbstractTableModel>
#include <QStringList>
#include <optional>
#include <vector>

#include "gui/data/browser.h"
#include "gui/data/differences.h"
#include "gui/data/memory_log.h"

namespace loci::gui {

/// A read-only table: columns with titles, lines of a list.
class TableModel : public QAbstractTableModel {
  Q_OBJECT

 public:
  int rowCount(const QModelIndex& parent = {}) const override;
  int columnCount(const QModelIndex& parent = {}) const override;
  QVariant headerData(int section, Qt::Orientation orientation, int role) const override;

 protected:
  TableModel(QStringList titles, QObject* parent);

  virtual size_t line_count() const = 0;

  QStringList titles_;
  QStringList tips_ = {};  ///< of the titles; may be shorter
};

/// The history of the selected object: since when, what happened, where, how sure. Newest first.
class HistoryModel : public TableModel {
  Q_OBJECT

 public:
  enum Column { time_column, what_column, place_column, probability_column };
  enum Role { time_role = Qt::UserRole };  ///< qlonglong nanoseconds

  explicit HistoryModel(Browser& browser, QObject* parent = nullptr);

  QVariant data(const QModelIndex& index, int role = Qt::DisplayRole) const override;

 protected:
  size_t line_count() const override { return entries_.size(); }

 private:
  void refresh();
  void set_entries(std::vector<memory::Change> entries);
  QString time_cell(const memory::Change& entry, bool full) const;
  bool is_now(size_t row) const;

  Browser& browser_;
  std::optional<int64_t> object_;
  std::vector<memory::Change> entries_;
};

/// Differences between two beliefs.
class DifferencesModel : public TableModel {
  Q_OBJECT

 public:
  enum Column { what_column, name_column, then_column, now_column };

  explicit DifferencesModel(QObject* parent = nullptr);

  void set(std::vector<Difference> differences, const QString& then, const QString& now);
  const std::vector<Difference>& differences() const { return differences_; }

  QVariant data(const QModelIndex& index, int role = Qt::DisplayRole) const override;

 protected:
  size_t line_count() const override { return differences_.size(); }

 private:
  std::vector<Difference> differences_;
};

/// Errors since the window was opened, then the runs and scenes of the memory.
class LogModel : public TableModel {
  Q_OBJECT

 public:
  enum Column { time_column, what_column, text_column };

  explicit LogModel(Browser& browser, QObject* parent = nullptr);

  QVariant data(const QModelIndex& index, int role = Qt::DisplayRole) const override;
  const LogEntry& entry(int row) const;
  /// An error of the window itself; the newest comes first.
  void add_problem(const QString& message);
  void set_memory_log(std::vector<LogEntry> entries);

 protected:
  size_t line_count() const override { return problems_.size() + entries_.size(); }

 private:
  QString time_cell(const LogEntry& entry) const;

  Browser& browser_;
  std::vector<LogEntry> problems_;  ///< oldest first
  std::vector<LogEntry> entries_;
};

}  // namespace loci::gui
