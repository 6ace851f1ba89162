#include "gui/models/history_model.h"

#include <QApplication>
#include <QFont>
#include <algorithm>

#include "gui/text.h"

namespace loci::gui {

HistoryModel::HistoryModel(Browser& browser, QObject* parent)
    : QAbstractTableModel(parent), browser_(browser) {
  connect(&browser_, &Browser::selected, this, &HistoryModel::refresh);
  connect(&browser_, &Browser::opened, this, &HistoryModel::refresh);
  connect(&browser_, &Browser::time_changed, this, [this] {
    if (!entries_.empty()) Q_EMIT dataChanged(index(0, 0), index(rowCount() - 1, column_count - 1));
  });
  refresh();
}

void HistoryModel::refresh() {
  const auto object = browser_.selection().object();
  if (object != object_) set_entries({});  // what is shown of another object is wrong
  object_ = object;
  if (!object || browser_.data() == nullptr) {
    browser_.reader().forget(this, "history");
    return set_entries({});
  }
  browser_.reader().read<std::vector<HistoryEntry>>(
      this, "history", Urgency::selection,
      [id = *object](const BrowserData& memory) { return memory.history(id); },
      [this](std::vector<HistoryEntry>& entries) {
        std::reverse(entries.begin(), entries.end());
        set_entries(std::move(entries));
      });
}

void HistoryModel::set_entries(std::vector<HistoryEntry> entries) {
  beginResetModel();
  entries_ = std::move(entries);
  endResetModel();
}

int HistoryModel::rowCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(entries_.size());
}

int HistoryModel::columnCount(const QModelIndex&) const {
  return column_count;
}

/// Whether the chosen time falls into this row.
bool HistoryModel::is_now(size_t row) const {
  const TimeNs time = browser_.selection().time();
  return entries_[row].from <= time && (row == 0 || time < entries_[row - 1].from);
}

QVariant HistoryModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid()) return {};
  const auto row = static_cast<size_t>(index.row());
  const HistoryEntry& entry = entries_[row];
  if (role == time_role) return static_cast<qlonglong>(entry.from);
  if (role == Qt::FontRole && is_now(row)) {
    QFont font = QApplication::font();
    font.setBold(true);
    return font;
  }
  if (role != Qt::DisplayRole && role != Qt::ToolTipRole) return {};
  switch (index.column()) {
    case time_column: {
      // The date is only told where it differs from the chosen one.
      const int zone = browser_.data()->info().zone_minutes;
      const QString text = time_text(entry.from, zone);
      const bool same_day = text.left(10) == time_text(browser_.selection().time(), zone).left(10);
      return same_day && role == Qt::DisplayRole ? text.mid(11, 8) : text.left(19);
    }
    case what_column:
      return QString::fromStdString(entry.what);
    case place_column:
      return QString::fromStdString(entry.place);
    case probability_column:
      return percent_text(entry.probability);
    default:
      return {};
  }
}

QVariant HistoryModel::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation == Qt::Horizontal && role == Qt::ToolTipRole)
    return section == probability_column
               ? "How sure the memory was of this: of who it was, that it was there, or that it was gone"
           : section == time_column ? "When it was noticed first"
                                    : QVariant();
  if (orientation != Qt::Horizontal || role != Qt::DisplayRole) return {};
  switch (section) {
    case time_column:
      return "Since";
    case what_column:
      return "What";
    case place_column:
      return "Where";
    default:
      return "Sure";
  }
}

}  // namespace loci::gui
