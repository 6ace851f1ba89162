#include "gui/models/log_model.h"

#include <QApplication>
#include <QDateTime>

#include "gui/text.h"
#include "gui/theme.h"

namespace loci::gui {

LogModel::LogModel(Browser& browser, QObject* parent) : QAbstractTableModel(parent), browser_(browser) {}

int LogModel::rowCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(problems_.size() + entries_.size());
}

int LogModel::columnCount(const QModelIndex&) const {
  return column_count;
}

const LogEntry& LogModel::entry(int row) const {
  const auto index = static_cast<size_t>(row);
  return index < problems_.size() ? problems_[problems_.size() - 1 - index]
                                  : entries_[index - problems_.size()];
}

void LogModel::add_problem(const QString& message) {
  beginInsertRows({}, 0, 0);
  LogEntry entry{.time = QDateTime::currentMSecsSinceEpoch() * (kSecond / 1000), .what = "problem"};
  entry.text = message.section('\n', 0, 0).toStdString();
  entry.details = message.toStdString();
  if (browser_.data() != nullptr) entry.details += "\nin " + browser_.data()->info().path;
  entry.is_problem = true;
  problems_.push_back(std::move(entry));
  endInsertRows();
}

void LogModel::set_memory_log(std::vector<LogEntry> entries) {
  beginResetModel();
  entries_ = std::move(entries);
  endResetModel();
}

QVariant LogModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid()) return {};
  const LogEntry& entry = this->entry(index.row());
  if (role == Qt::ForegroundRole)
    return entry.is_problem ? QVariant(Theme::of(QApplication::palette()).gone) : QVariant();
  if (role == Qt::ToolTipRole) return QString::fromStdString(entry.details).left(1000);
  if (role != Qt::DisplayRole) return {};
  switch (index.column()) {
    case time_column: {
      if (entry.time == 0) return "all runs";
      // The date of a scene is only told where it differs from the chosen one.
      const int zone = browser_.data() == nullptr ? 0 : browser_.data()->info().zone_minutes;
      const QString text = time_text(entry.time, zone);
      const bool same_day =
          entry.scene && text.left(10) == time_text(browser_.selection().time(), zone).left(10);
      return same_day ? text.mid(11) : text.mid(5, 11);
    }
    case what_column:
      return QString::fromStdString(entry.scene ? "  " + entry.what : entry.what);
    case text_column:
      return QString::fromStdString(entry.text);
    default:
      return {};
  }
}

QVariant LogModel::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation != Qt::Horizontal || role != Qt::DisplayRole) return {};
  return section == time_column ? "When" : section == what_column ? "What" : "How it went";
}

}  // namespace loci::gui
