// The menus, keys and tools of the window: every action is declared once, here.

#include <QAction>
#include <QClipboard>
#include <QDockWidget>
#include <QFileDialog>
#include <QFileInfo>
#include <QGuiApplication>
#include <QLineEdit>
#include <QMenuBar>
#include <QMessageBox>
#include <QSettings>
#include <QToolBar>
#include <QToolButton>

#include "gui/main_window.h"
#include "gui/shortcut_sheet.h"
#include "gui/views/map_tools.h"
#include "gui/views/object_card.h"
#include "gui/views/objects_tree.h"
#include "gui/views/question_bar.h"
#include "gui/views/scene_image.h"
#include "gui/views/time_bar.h"
#include "mapping/base/error.h"

namespace loci::gui {

QAction* MainWindow::add_action(QMenu* menu, const Key& key, const std::function<void()>& run) {
  QAction* action = menu->addAction(key.text);
  action->setShortcuts(key.keys);
  QString tip = key.tip.isEmpty() ? QString(key.text).remove('&') : key.tip;
  if (!key.keys.isEmpty()) tip += " (" + key.keys.front().toString(QKeySequence::NativeText) + ")";
  action->setToolTip(tip);
  action->setStatusTip(tip);
  if (run) connect(action, &QAction::triggered, this, [run] { run(); });
  return action;
}

QAction* MainWindow::add_check(QMenu* menu, const Key& key, bool on, const std::function<void(bool)>& run) {
  QAction* action = add_action(menu, key, {});
  action->setCheckable(true);
  action->setChecked(on);
  connect(action, &QAction::toggled, this, [run](bool checked) { run(checked); });
  return action;
}

QList<QMenu*> MainWindow::menus() const {
  QList<QMenu*> menus;
  for (const QAction* action : menuBar()->actions())
    if (action->menu() != nullptr) menus << action->menu();
  return menus;
}

void MainWindow::build_file_menu() {
  QMenu* menu = menuBar()->addMenu("&File");
  tools_ << add_action(menu, {"&Open…", {QKeySequence("Ctrl+O")}, "Open a memory"},
                       [this] { ask_for_file(); });
  recent_ = menu->addMenu("Open &recent");
  add_action(menu, {"&Check this file", {}, "Reads the whole memory and says whether it is sound"}, [this] {
    if (browser_.data() != nullptr) check_file(QString::fromStdString(browser_.data()->info().path));
  });
  build_export_menu(menu);
  menu->addSeparator();
  add_action(menu, {"&Save image…", {QKeySequence("Ctrl+P")}, "Save this window as an image"},
             [this] { save_image(); });
  menu->addSeparator();
  add_action(menu, {"&Quit", {QKeySequence("Ctrl+Q")}, ""}, [this] { close(); });
}

void MainWindow::build_edit_menu() {
  QMenu* menu = menuBar()->addMenu("&Edit");
  QAction* undo = add_action(menu, {"&Undo", {QKeySequence("Ctrl+Z")}, "Takes back what was said last"},
                             [this] { edits_.undo(); });
  QAction* redo =
      add_action(menu, {"&Redo", {QKeySequence("Ctrl+Shift+Z"), QKeySequence("Ctrl+Y")}, "Says it again"},
                 [this] { edits_.redo(); });
  menu->addSeparator();
  const auto now = [this](auto member) {
    const BelievedObject* object = browser_.selected_object();
    return object == nullptr ? QString() : QString::fromStdString(object->*member);
  };
  add_action(menu, {"Re&name…", {QKeySequence("F2")}, "What people call the chosen object or place"},
             [this] { rename_selected(); });
  add_action(menu, {"&Class…", {QKeySequence("Ctrl+L")}, "What kind of thing the chosen object is"},
             [this, now] { edit_selected("Class", "class", now(&BelievedObject::class_name)); });
  add_action(menu, {"&Owner…", {QKeySequence("Ctrl+Shift+O")}, "Whose the chosen object is"},
             [this, now] { edit_selected("Owner", "owner", now(&BelievedObject::owner)); });
  menu->addSeparator();
  add_action(menu, {"Is the &same as…", {QKeySequence("Ctrl+J")}, "The chosen object and another are one"},
             [this] { merge_selected(); });
  add_action(menu,
             {"Is &another from now on",
              {QKeySequence("Ctrl+Shift+J")},
              "What is seen of the chosen object from the chosen time on is another one"},
             [this] { split_selected(); });
  add_action(menu,
             {"&Label…", {QKeySequence("Ctrl+B")}, "What the chosen object is in this image, for training"},
             [this] { label_selected(); });
  add_action(menu, {"&Joint…", {}, "Corrects how a part of the map moves: the joint of the chosen place"},
             [this] { correct_joint(); });
  add_action(menu, {"Joint's na&me…", {}, "Names a joint of the map: loci-memory edit part JOINT NAME"},
             [this] { name_joint(); });
  const auto refresh = [this, undo, redo] {
    undo->setEnabled(edits_.can_undo());
    redo->setEnabled(edits_.can_redo());
  };
  connect(&edits_, &EditHistory::changed, this, refresh);
  refresh();
}

void MainWindow::build_time_menu() {
  QMenu* menu = menuBar()->addMenu("&Time");
  add_action(menu, {"&Previous scene", {QKeySequence("Left")}, ""}, [this] { browser_.step(-1); });
  add_action(menu, {"&Next scene", {QKeySequence("Right")}, ""}, [this] { browser_.step(1); });
  add_action(
      menu,
      {"Previous &observation", {QKeySequence("Ctrl+Left")}, "The scene before that saw the chosen object"},
      [this] { browser_.step_observation(-1); });
  add_action(menu,
             {"Next o&bservation", {QKeySequence("Ctrl+Right")}, "The next scene that saw the chosen object"},
             [this] { browser_.step_observation(1); });
  add_action(menu, {"&First scene", {QKeySequence("Home")}, ""}, [this] { browser_.to_first(); });
  add_action(menu, {"&Last scene", {QKeySequence("End")}, ""}, [this] { browser_.to_last(); });
  menu->addSeparator();
  const auto zoom = [this](double factor) { time_->axis().zoom(factor, browser_.selection().time()); };
  add_action(menu,
             {"&Shorter time",
              {QKeySequence("Ctrl++"), QKeySequence("Ctrl+=")},
              "Shows less time, around the chosen one"},
             [zoom] { zoom(0.5); });
  add_action(menu, {"&Longer time", {QKeySequence("Ctrl+-")}, "Shows more time"}, [zoom] { zoom(2); });
  add_action(menu, {"&Whole time", {QKeySequence("Ctrl+0")}, "Shows all of the memory's time"},
             [this] { time_->axis().show_all(); });
  menu->addSeparator();
  add_action(menu, {"Pl&ay or pause", {QKeySequence("Space")}, ""}, [this] { time_->toggle_play(); });
  add_action(menu, {"Go to &time", {QKeySequence("Ctrl+T")}, "Type a date or a time of the day"}, [this] {
    time_->stamp()->setFocus();
    time_->stamp()->selectAll();
  });
}

void MainWindow::build_select_menu() {
  QMenu* menu = menuBar()->addMenu("&Selection");
  tools_ << add_action(menu,
                       {"&Ask…",
                        {QKeySequence("Ctrl+K"), QKeySequence("/")},
                        "Ask the memory in words, or run a command by its name"},
                       [this] { questions_->open(); })
         << nullptr;
  add_action(menu, {"&Search", {QKeySequence("Ctrl+F")}, "Search the tree"}, [this] {
    tree_->search()->setFocus();
    tree_->search()->selectAll();
  });
  tools_ << add_action(menu,
                       {"&Frame", {QKeySequence("F")}, "Move the eye so that the selection fills the view"},
                       [this] { map_->frame_selection(); });
  add_action(menu, {"&Clear", {QKeySequence("Esc")}, "Nothing chosen, nothing searched"}, [this] {
    tree_->show_all();
    browser_.selection().clear();
  });
  add_action(menu, {"Co&py", {QKeySequence("Ctrl+Shift+C")}, "Copy what the card says"},
             [this] { copy_card(); });
}

void MainWindow::build_view_menu() {
  QMenu* menu = menuBar()->addMenu("&View");
  const auto look = [&](const QString& text, const QString& key, MapViewpoint viewpoint) {
    return add_action(menu, {text, {QKeySequence(key)}, text + " of the room"},
                      [this, viewpoint] { map_->look_from(viewpoint); });
  };
  tools_ << nullptr << look("Overview", "1", MapViewpoint::overview) << look("Top", "2", MapViewpoint::top)
         << look("Front", "3", MapViewpoint::front) << look("Left", "4", MapViewpoint::left) << nullptr;
  menu->addSeparator();
  const auto layer = [&](const QString& text, const QString& key, const QString& tip, MapLayer which) {
    return add_check(menu, {text, {QKeySequence(key)}, tip}, map_->scene().layer(which),
                     [this, which](bool on) { maps_->set_layer(which, on); });
  };
  tools_ << layer("Map", "M", "Walls, furniture and their joints", MapLayer::map)
         << layer("Objects", "O", "Boxes where objects are believed to be", MapLayer::objects)
         << layer("Labels", "L", "Names of objects", MapLayer::labels)
         << layer("Cloud", "C", "The points measured in the chosen scene", MapLayer::cloud)
         << layer("Camera", "K", "Where the chosen scene was looked at from", MapLayer::camera) << nullptr;
  layer("Way", "T", "Where the chosen object has been until the chosen time", MapLayer::trace);
  layer("All cameras", "Shift+K", "From where all scenes were looked at", MapLayer::cameras);
  add_action(menu, {"Measure", {QKeySequence("R")}, "Two clicks in the map: how far they are apart"}, [this] {
    show_dock("tools3d");
    map_tools_->ruler()->toggle();
  });
  menu->addSeparator();
  tools_ << add_check(menu, {"Depth image", {QKeySequence("D")}, "Depth instead of colour"}, false,
                      [this](bool on) { image().show_depth(on); });
  add_check(menu, {"Masks", {QKeySequence("N")}, "Around what belongs to each thing in the image"}, true,
            [this](bool on) { image().show_masks(on); });
  add_check(menu,
            {"Known, irrelevant, of interest",
             {QKeySequence("I")},
             "Tints the image: what the map explains, what is in no region of interest, and where things are "
             "looked for"},
            false, [this](bool on) { image().show_kinds(on); });
  add_action(menu, {"Larger points", {QKeySequence("+")}, ""}, [this] { maps_->change_point_size(1); });
  add_action(menu, {"Smaller points", {QKeySequence("-")}, ""}, [this] { maps_->change_point_size(-1); });
  menu->addSeparator();
  for (const auto* dock : findChildren<QDockWidget*>()) menu->addAction(dock->toggleViewAction());
  add_action(menu, {"Restore default layout", {}, ""}, [this] { default_layout(); });
}

void MainWindow::build_help_menu() {
  QMenu* menu = menuBar()->addMenu("&Help");
  add_action(menu, {"&Keys and mouse", {QKeySequence("F1"), QKeySequence("?")}, ""}, [this] { show_keys(); });
}

void MainWindow::build_toolbar() {
  QToolBar* bar = addToolBar("Tools");
  bar->setObjectName("tools");
  bar->setMovable(false);
  bar->setToolButtonStyle(Qt::ToolButtonTextOnly);
  for (QAction* action : tools_) {
    if (action == nullptr)
      bar->addSeparator();
    else
      bar->addAction(action);
  }
}

void MainWindow::refresh_recent() {
  recent_->clear();
  if (options_.remember)
    for (const QString& path : QSettings().value("recent").toStringList())
      recent_->addAction(path, this, [this, path] { open(path); });
  recent_->setEnabled(!recent_->isEmpty());
}

void MainWindow::save_image() {
  const QString path = QFileDialog::getSaveFileName(this, "Save image", "browser.png", "Images (*.png)");
  if (path.isEmpty()) return;
  try {
    if (!screenshot().save(path)) throw Error("cannot write the image", {path.toStdString(), 0, {}});
    tell("Saved " + path);
  } catch (const Error& error) {
    QMessageBox::warning(this, "No image", QString::fromUtf8(error.what()));
  }
}

void MainWindow::copy_card() {
  QGuiApplication::clipboard()->setText(card_->text());
  tell("Copied");
}

void MainWindow::show_keys() {
  ShortcutSheet sheet(menus(), this);
  sheet.exec();
}

}  // namespace loci::gui
