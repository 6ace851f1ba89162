#include "gui/shortcut_sheet.h"

#include <QAction>
#include <QGridLayout>
#include <QLabel>
#include <QMenu>
#include <array>

namespace loci::gui {
namespace {

QString keys_of(const QAction& action) {
  QStringList keys;
  for (const QKeySequence& key : action.shortcuts()) keys << key.toString(QKeySequence::NativeText);
  return keys.join(" or ");
}

QString plain(QString text) {
  return text.remove('&').remove("…");
}

const QList<std::pair<QString, QString>> kMouse = {{"Turn the map", "left drag"},
                                                   {"Shift the map", "middle drag, Shift + left drag"},
                                                   {"Zoom", "wheel, right drag"},
                                                   {"Point size", "Ctrl + wheel"},
                                                   {"Zoom in time", "wheel over the scenes"},
                                                   {"Select", "click in map, tree or image"}};

int add_block(QGridLayout& grid, int column, int row, const QString& title,
              const QList<std::pair<QString, QString>>& lines) {
  auto* head = new QLabel("<b>" + title.toHtmlEscaped() + "</b>");
  grid.addWidget(head, row++, column, 1, 2);
  for (const auto& [what, keys] : lines) {
    grid.addWidget(new QLabel(what), row, column);
    grid.addWidget(new QLabel(keys), row++, column + 1);
  }
  grid.addWidget(new QLabel, row++, column);
  return row;
}

QList<std::pair<QString, QString>> lines_of_menu(const QMenu& menu) {
  QList<std::pair<QString, QString>> lines;
  for (const QAction* action : menu.actions())
    if (!action->shortcuts().isEmpty()) lines.append({plain(action->text()), keys_of(*action)});
  return lines;
}

}  // namespace

ShortcutSheet::ShortcutSheet(const QList<QMenu*>& menus, QWidget* parent) : QDialog(parent) {
  setWindowTitle("Keys and mouse");
  auto* grid = new QGridLayout(this);
  grid->setContentsMargins(20, 16, 20, 12);
  grid->setHorizontalSpacing(24);
  grid->setVerticalSpacing(4);
  std::array<int, 2> next_row = {0, 0};
  for (const QMenu* menu : menus) {
    const auto lines = lines_of_menu(*menu);
    if (lines.isEmpty()) continue;
    const size_t side = next_row[0] <= next_row[1] ? 0 : 1;
    next_row[side] =
        add_block(*grid, static_cast<int>(side) * 2, next_row[side], plain(menu->title()), lines);
  }
  const size_t side = next_row[0] <= next_row[1] ? 0 : 1;
  add_block(*grid, static_cast<int>(side) * 2, next_row[side], "Mouse", kMouse);
}

QStringList ShortcutSheet::lines_of(const QList<QMenu*>& menus) {
  QStringList lines;
  for (const QMenu* menu : menus)
    for (const auto& [what, keys] : lines_of_menu(*menu)) lines << what + "\t" + keys;
  return lines;
}

}  // namespace loci::gui
