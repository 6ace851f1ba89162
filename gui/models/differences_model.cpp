#include "gui/models/differences_model.h"

#include <QApplication>

#include "gui/theme.h"

namespace loci::gui {
namespace {

QColor color_of(Difference::Kind kind) {
  const Theme theme = Theme::of(QApplication::palette());
  switch (kind) {
    case Difference::Kind::appeared:
      return theme.of_event("appeared");
    case Difference::Kind::moved:
      return theme.of_event("moved");
    case Difference::Kind::gone:
      return theme.of_event("gone");
    case Difference::Kind::joint:
      return theme.of_event("joint_changed");
  }
  return theme.text;
}

QString text_of(const Difference& difference, int column) {
  const auto or_dash = [](const std::string& text) {
    return text.empty() ? QString("–") : QString::fromStdString(text);
  };
  if (column == DifferencesModel::name_column) return QString::fromStdString(difference.name);
  if (column == DifferencesModel::then_column) return or_dash(difference.then);
  if (column == DifferencesModel::now_column) return or_dash(difference.now);
  QString what = difference_name(difference.kind);
  if (difference.kind == Difference::Kind::moved && difference.then == difference.now)
    what += QString(" %1 cm").arg(difference.distance * 100, 0, 'f', 0);
  return what;
}

}  // namespace

void DifferencesModel::set(std::vector<Difference> differences, const QString& then, const QString& now) {
  beginResetModel();
  differences_ = std::move(differences);
  then_ = then;
  now_ = now;
  endResetModel();
}

int DifferencesModel::rowCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(differences_.size());
}

int DifferencesModel::columnCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : column_count;
}

QVariant DifferencesModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid()) return {};
  const Difference& difference = differences_[static_cast<size_t>(index.row())];
  if (role == Qt::DisplayRole || role == Qt::ToolTipRole) return text_of(difference, index.column());
  if (role == Qt::ForegroundRole && index.column() == what_column) return color_of(difference.kind);
  return {};
}

QVariant DifferencesModel::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation != Qt::Horizontal || role != Qt::DisplayRole) return {};
  return section == what_column   ? QString()
         : section == name_column ? "What"
         : section == then_column ? then_
                                  : now_;
}

}  // namespace loci::gui
