#pragma once

#include <QDialog>
#include <QList>

class QMenu;

namespace loci::gui {

/// The keys of all actions in the given menus, and what the mouse does: made from the actions themselves, so
/// that it is always true.
class ShortcutSheet : public QDialog {
  Q_OBJECT

 public:
  ShortcutSheet(const QList<QMenu*>& menus, QWidget* parent = nullptr);

  /// "Next scene\tRight", one line per action.
  static QStringList lines_of(const QList<QMenu*>& menus);
};

}  // namespace loci::gui
