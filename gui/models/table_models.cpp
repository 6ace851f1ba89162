#include "gui/models/table_models.h"

#include <QApplication>
#include <QDateTime>
#include <QFont>
#include <algorithm>

#include "gui/core/text.h"
#include "gui/core/theme.h"

namespace loci::gui {
namespace {

QString cell_of(const Difference& difference, int column) {
  const auto or_dash = [](const std::string& text) {
    return text.empty() ? QString("–") : QString::fromStdString(text);
  };
  if (column == DifferencesModel::name_column) return QString::fromStdString(difference.name);
  if (column == DifferencesModel::then_column) return or_dash(difference.then);
  if (column == DifferencesModel::now_column) return or_dash(difference.now);
  QString what = state_text(difference.kind);
  if (difference.kind == memory::EventKind::moved && difference.distance > 0)
    what += difference.distance < 0.995 ? QString(" %1 cm").arg(difference.distance * 100, 0, 'f', 0)
                                        : QString(" %1 m").arg(difference.distance, 0, 'f', 1);
  return what;
}

}  // namespace

TableModel::TableModel(QStringList titles, QObject* parent)
    : QAbstractTableModel(parent), titles_(std::move(titles)) {}

int TableModel::rowCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(line_count());
}

int TableModel::columnCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : titles_.size();
}

QVariant TableModel::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation != Qt::Horizontal) return {};
  if (role == Qt::DisplayRole) return titles_.value(section);
  const QString tip = tips_.value(section);
  return role == Qt::ToolTipRole && !tip.isEmpty() ? QVariant(tip) : QVariant();
}

// ---- History.

HistoryModel::HistoryModel(Browser& browser, QObject* parent)
    : TableModel({"Since", "Change", "Where", "Prob."}, parent), browser_(browser) {
  tips_ = QStringList{
      "When it was noticed first", "", "",
      "Probability of the change, as loci-memory changes gives it; that the object is still there stands "
      "above"};
  connect(&browser_, &Browser::selected, this, &HistoryModel::refresh);
  connect(&browser_, &Browser::opened, this, &HistoryModel::refresh);
  connect(&browser_, &Browser::time_changed, this, [this] {
    if (!entries_.empty()) Q_EMIT dataChanged(index(0, 0), index(rowCount() - 1, columnCount() - 1));
  });
  refresh();
}

void HistoryModel::refresh() {
  const auto object = browser_.selection().object();
  if (object != object_) set_entries({});  // of another object
  object_ = object;
  if (!object || browser_.data() == nullptr) {
    browser_.reader().forget(this, "history");
    return set_entries({});
  }
  browser_.reader().read<std::vector<memory::Change>>(
      this, "history", Urgency::selection,
      [id = *object](const OpenMemory& memory) { return memory.history(id); },
      [this](std::vector<memory::Change>& entries) {
        std::reverse(entries.begin(), entries.end());
        set_entries(std::move(entries));
      });
}

void HistoryModel::set_entries(std::vector<memory::Change> entries) {
  beginResetModel();
  entries_ = std::move(entries);
  endResetModel();
}

/// Whether the selected time falls into this row.
bool HistoryModel::is_now(size_t row) const {
  const TimeNs time = browser_.selection().time();
  return entries_[row].time <= time && (row == 0 || time < entries_[row - 1].time);
}

/// The date is shown where it differs from that of the selected time.
QString HistoryModel::time_cell(const memory::Change& entry, bool full) const {
  const TimeZone& zone = browser_.data()->info().zone;
  const QString text = time_text(entry.time, zone);
  const bool same_day = text.left(10) == time_text(browser_.selection().time(), zone).left(10);
  return same_day && !full ? text.mid(11, 8) : text.left(19);
}

QVariant HistoryModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid()) return {};
  const auto row = static_cast<size_t>(index.row());
  const memory::Change& entry = entries_[row];
  if (role == time_role) return static_cast<qlonglong>(entry.time);
  if (role == Qt::FontRole && is_now(row)) return bold_font(QApplication::font());
  if (role != Qt::DisplayRole && role != Qt::ToolTipRole) return {};
  switch (index.column()) {
    case time_column:
      return time_cell(entry, role == Qt::ToolTipRole);
    case what_column:
      return state_text(entry.kind);
    case place_column: {
      const auto& place = entry.place ? entry.place : entry.from_place;
      return place ? QString::fromStdString(place->name) : QString();
    }
    case probability_column:
      return percent_text(entry.probability);
    default:
      return {};
  }
}

// ---- Differences.

DifferencesModel::DifferencesModel(QObject* parent) : TableModel({"", "What", "Then", "Now"}, parent) {}

void DifferencesModel::set(std::vector<Difference> differences, const QString& then, const QString& now) {
  beginResetModel();
  differences_ = std::move(differences);
  titles_[then_column] = then;
  titles_[now_column] = now;
  endResetModel();
}

QVariant DifferencesModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid()) return {};
  const Difference& difference = differences_[static_cast<size_t>(index.row())];
  if (role == Qt::DisplayRole || role == Qt::ToolTipRole) return cell_of(difference, index.column());
  if (role == Qt::ForegroundRole && index.column() == what_column)
    return Theme::of(QApplication::palette()).of_event(difference.kind);
  return {};
}

// ---- Log.

LogModel::LogModel(Browser& browser, QObject* parent)
    : TableModel({"When", "What", "How it went"}, parent), browser_(browser) {}

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

/// The date of a scene is shown where it differs from that of the selected time.
QString LogModel::time_cell(const LogEntry& entry) const {
  if (entry.time == 0) return "all runs";
  const TimeZone zone = browser_.data() == nullptr ? TimeZone() : browser_.data()->info().zone;
  const QString text = time_text(entry.time, zone);
  const bool same_day = entry.scene && text.left(10) == time_text(browser_.selection().time(), zone).left(10);
  return same_day ? text.mid(11) : text.mid(5, 11);
}

QVariant LogModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid()) return {};
  const LogEntry& entry = this->entry(index.row());
  if (role == Qt::ForegroundRole)
    return entry.is_problem ? QVariant(Theme::of(QApplication::palette()).gone) : QVariant();
  if (role == Qt::ToolTipRole) return QString::fromStdString(entry.details).left(1000);
  if (role != Qt::DisplayRole) return {};
  switch (index.column()) {
    case time_column:
      return time_cell(entry);
    case what_column:
      return QString::fromStdString(entry.scene ? "  " + entry.what : entry.what);
    case text_column:
      return QString::fromStdString(entry.text);
    default:
      return {};
  }
}

}  // namespace loci::gui
