#pragma once

#include <QDialog>
#include <QList>
#include <functional>

class QAction;
class QMenu;

namespace loci::gui {

class MainWindow;

/// The menus, keys and tools of the window: every action is declared once, here.
class Menus {
 public:
  /// Adds them to the window, whose views exist.
  explicit Menus(MainWindow& window);

  const QList<QMenu*>& menus() const { return menus_; }
  /// Actions of the menus, without those of sub-menus.
  QList<QAction*> actions() const;

 private:
  enum Place { in_menu, in_toolbar };
  struct Action {
    QString text;
    QStringList keys;
    QString tip;  ///< empty = the text
    std::function<void()> run;
    Place place = in_menu;
  };
  struct Switch {
    QString text, key, tip;
    bool on;
    std::function<void(bool)> set;
    Place place = in_menu;
  };
  QMenu* add_menu(const QString& title);
  QAction* add(QMenu* menu, const Action& action);
  void add(QMenu* menu, const std::vector<Action>& actions);
  void add(QMenu* menu, const Switch& option);
  void separate_tools() { tools_ << nullptr; }

  void build_file_menu();
  void build_export_menu(QMenu* file);
  void build_time_menu();
  void build_edit_menu();
  void build_selection_menu();
  void build_view_menu();
  void add_layers(QMenu* menu);
  void add_image_options(QMenu* menu);
  void build_help_menu();
  void build_toolbar();
  void save_image();

  MainWindow& window_;
  QList<QMenu*> menus_;
  QList<QAction*> tools_;  ///< of the tool bar; nullptr = a separator
};

/// The keys of all actions in the given menus, and what the mouse does: made from the actions themselves.
class ShortcutSheet : public QDialog {
  Q_OBJECT

 public:
  ShortcutSheet(const QList<QMenu*>& menus, QWidget* parent = nullptr);

  /// "Next scene\tRight", one line per action.
  static QStringList lines_of(const QList<QMenu*>& menus);
};

}  // namespace loci::gui
