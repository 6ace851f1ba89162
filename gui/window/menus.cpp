#include "gui/window/menus.h"

#include <QAction>
#include <QClipboard>
#include <QDockWidget>
#include <QFileDialog>
#include <QGridLayout>
#include <QGuiApplication>
#include <QLabel>
#include <QLineEdit>
#include <QMenuBar>
#include <QMessageBox>
#include <QToolBar>
#include <QToolButton>
#include <array>

#include "gui/views/map/map_tools.h"
#include "gui/views/object_card.h"
#include "gui/views/objects_tree.h"
#include "gui/views/question_bar.h"
#include "gui/views/scene_view.h"
#include "gui/views/timeline/time_bar.h"
#include "gui/window/exporter.h"
#include "gui/window/main_window.h"
#include "gui/window/object_editor.h"
#include "mapping/base/error.h"

namespace loci::gui {

// ---- How actions are added.

Menus::Menus(MainWindow& window) : window_(window) {
  build_file_menu();
  build_time_menu();
  build_edit_menu();
  build_selection_menu();
  build_view_menu();
  build_help_menu();
  build_toolbar();
}

QMenu* Menus::add_menu(const QString& title) {
  menus_ << window_.menuBar()->addMenu(title);
  return menus_.back();
}

QAction* Menus::add(QMenu* menu, const Action& action) {
  QAction* added = menu->addAction(action.text);
  QList<QKeySequence> keys;
  for (const QString& key : action.keys) keys << QKeySequence(key);
  added->setShortcuts(keys);
  QString tip = action.tip.isEmpty() ? QString(action.text).remove('&') : action.tip;
  if (!keys.isEmpty()) tip += " (" + keys.front().toString(QKeySequence::NativeText) + ")";
  added->setToolTip(tip);
  added->setStatusTip(tip);
  if (action.run) QObject::connect(added, &QAction::triggered, added, [run = action.run] { run(); });
  if (action.place == in_toolbar) tools_ << added;
  return added;
}

void Menus::add(QMenu* menu, const std::vector<Action>& actions) {
  for (const Action& action : actions) add(menu, action);
}

void Menus::add(QMenu* menu, const Switch& option) {
  QAction* added = add(menu, Action{option.text, {option.key}, option.tip, {}, option.place});
  added->setCheckable(true);
  added->setChecked(option.on);
  QObject::connect(added, &QAction::toggled, added, [set = option.set](bool on) { set(on); });
}

QList<QAction*> Menus::actions() const {
  QList<QAction*> all;
  for (const QMenu* menu : menus_)
    for (QAction* action : menu->actions())
      if (!action->isSeparator() && action->menu() == nullptr) all << action;
  return all;
}

// ---- The menus.

void Menus::build_file_menu() {
  QMenu* menu = add_menu("&File");
  FileOpener& files = window_.files();
  add(menu, Action{"&Open…", {"Ctrl+O"}, "Open a memory", [&files] { files.ask_for_file(); }, in_toolbar});
  files.set_recent_menu(menu->addMenu("Open &recent"));
  add(menu, Action{"&Check this file", {}, "Reads the whole memory and reports whether it is intact", [this] {
                     if (window_.browser().data() != nullptr)
                       window_.files().verify(QString::fromStdString(window_.browser().data()->info().path));
                   }});
  build_export_menu(menu);
  menu->addSeparator();
  add(menu, Action{"&Save image…", {"Ctrl+P"}, "Save this window as an image", [this] { save_image(); }});
  menu->addSeparator();
  add(menu, Action{"&Quit", {"Ctrl+Q"}, "", [this] { window_.close(); }});
}

/// Each tip names the command that writes the same.
void Menus::build_export_menu(QMenu* file) {
  QMenu* menu = file->addMenu("&Export");
  const auto add_export = [&](const QString& text, const QString& tip, void (Exporter::*write)()) {
    add(menu, Action{text, {}, tip, [this, write] {
                       if (window_.browser().data() == nullptr)
                         return window_.show_message("Open a memory first");
                       (window_.exporter().*write)();
                     }});
  };
  add_export("&Table of beliefs…",
             "What is believed at the selected time of the selected object or place, else of all, as CSV or "
             "JSON: loci-memory objects --at TIME --json, loci-memory on PLACE --json",
             &Exporter::table);
  add_export("&Images of the object…",
             "The selected object's images from all sides: loci-memory model OBJECT",
             &Exporter::object_images);
  add_export("&Scene's image…", "Colour image of the selected scene: loci-memory report",
             &Exporter::scene_image);
  add_export(
      "Measured &points…",
      "The points of the selected scene as PLY in the map frame, or of the selected object at its last "
      "observation, as fine as they are stored: loci-memory export -o FOLDER --include clouds, loci-memory "
      "model OBJECT",
      &Exporter::points);
  add_export("&Map…",
             "The map as URDF, with corrections by people: loci-memory export -o FOLDER --include map",
             &Exporter::map);
  add_export("&Report…", "A page about the whole memory: loci-memory report -o FILE", &Exporter::report);
}

void Menus::build_edit_menu() {
  QMenu* menu = add_menu("&Edit");
  EditHistory& edits = window_.edits();
  ObjectEditor& editor = window_.editor();
  QAction* undo =
      add(menu, Action{"&Undo", {"Ctrl+Z"}, "Takes back the last correction", [&edits] { edits.undo(); }});
  QAction* redo = add(menu, Action{"&Redo",
                                   {"Ctrl+Shift+Z", "Ctrl+Y"},
                                   "Applies the correction again that was taken back last",
                                   [&edits] { edits.redo(); }});
  menu->addSeparator();
  add(menu,
      {{"Re&name…", {"F2"}, "Name of the selected object or place", [&editor] { editor.rename(); }},
       {"&Class…", {"Ctrl+L"}, "Class of the selected object", [&editor] { editor.set_class(); }},
       {"&Owner…", {"Ctrl+Shift+O"}, "Owner of the selected object", [&editor] { editor.set_owner(); }}});
  menu->addSeparator();
  add(menu,
      {{"Is the &same as…",
        {"Ctrl+J"},
        "Merges the selected object with another",
        [&editor] { editor.merge(); }},
       {"Is &another from now on",
        {"Ctrl+Shift+J"},
        "Splits the selected object: what is seen of it from the selected time on is another object",
        [&editor] { editor.split(); }},
       {"&Label…",
        {"Ctrl+B"},
        "Class of the selected object in this image, as a training label",
        [&editor] { editor.label(); }},
       {"&Joint…", {}, "Type of a joint of the map", [&editor] { editor.set_joint_type(); }},
       {"Joint's na&me…", {}, "Name of a joint of the map: loci-memory edit part JOINT NAME", [&editor] {
          editor.rename_joint();
        }}});
  const auto refresh = [&edits, undo, redo] {
    undo->setEnabled(edits.can_undo());
    redo->setEnabled(edits.can_redo());
  };
  QObject::connect(&edits, &EditHistory::changed, undo, refresh);
  refresh();
}

void Menus::build_time_menu() {
  QMenu* menu = add_menu("&Time");
  Browser& browser = window_.browser();
  TimeBar& bar = window_.docks().time_bar();
  add(menu, {{"&Previous scene", {"Left"}, "", [&browser] { browser.step(-1); }},
             {"&Next scene", {"Right"}, "", [&browser] { browser.step(1); }},
             {"Previous &observation",
              {"Ctrl+Left"},
              "The previous scene that saw the selected object",
              [&browser] { browser.step_observation(-1); }},
             {"Next o&bservation",
              {"Ctrl+Right"},
              "The next scene that saw the selected object",
              [&browser] { browser.step_observation(1); }},
             {"&First scene", {"Home"}, "", [&browser] { browser.to_first(); }},
             {"&Last scene", {"End"}, "", [&browser] { browser.to_last(); }}});
  menu->addSeparator();
  const auto zoom = [&browser, &bar](double factor) {
    return [&browser, &bar, factor] { bar.axis().zoom(factor, browser.selection().time()); };
  };
  add(menu,
      {{"&Shorter time", {"Ctrl++", "Ctrl+="}, "Zooms in around the selected time", zoom(0.5)},
       {"&Longer time", {"Ctrl+-"}, "Zooms out", zoom(2)},
       {"&Whole time", {"Ctrl+0"}, "Shows all of the memory's time", [&bar] { bar.axis().show_all(); }}});
  menu->addSeparator();
  add(menu, {{"Pl&ay or pause", {"Space"}, "", [&bar] { bar.toggle_play(); }},
             {"Go to &time", {"Ctrl+T"}, "Type a date or a time of the day", [&bar] {
                bar.stamp()->setFocus();
                bar.stamp()->selectAll();
              }}});
}

void Menus::build_selection_menu() {
  QMenu* menu = add_menu("&Selection");
  add(menu, Action{"&Ask…",
                   {"Ctrl+K", "/"},
                   "Ask the memory in natural language, or run a command by its name",
                   [this] { window_.question_bar().open(); },
                   in_toolbar});
  separate_tools();
  ObjectsTree& tree = window_.docks().tree();
  add(menu, {{"&Search",
              {"Ctrl+F"},
              "Search the tree",
              [&tree] {
                tree.search()->setFocus();
                tree.search()->selectAll();
              }},
             {"&Frame",
              {"F"},
              "Move the viewpoint so that the selection fills the view",
              [this] { window_.map().frame_selection(); },
              in_toolbar},
             {"&Clear",
              {"Esc"},
              "Clear selection and search",
              [this, &tree] {
                tree.show_all();
                window_.browser().selection().clear();
              }},
             {"Co&py", {"Ctrl+Shift+C"}, "Copy the text of the card", [this] {
                QGuiApplication::clipboard()->setText(window_.docks().card().text());
                window_.show_message("Copied");
              }}});
}

void Menus::build_view_menu() {
  QMenu* menu = add_menu("&View");
  separate_tools();
  const auto add_viewpoint = [&](const QString& text, const QString& key, MapViewpoint viewpoint) {
    add(menu, Action{text,
                     {key},
                     text + " of the map",
                     [this, viewpoint] { window_.map().look_from(viewpoint); },
                     in_toolbar});
  };
  add_viewpoint("Overview", "1", MapViewpoint::overview);
  add_viewpoint("Top", "2", MapViewpoint::top);
  add_viewpoint("Front", "3", MapViewpoint::front);
  add_viewpoint("Left", "4", MapViewpoint::left);
  separate_tools();
  menu->addSeparator();
  add_layers(menu);
  menu->addSeparator();
  add_image_options(menu);
  add(menu, {{"Larger points", {"+"}, "", [this] { window_.maps().change_point_size(1); }},
             {"Smaller points", {"-"}, "", [this] { window_.maps().change_point_size(-1); }}});
  menu->addSeparator();
  for (const auto* dock : window_.docks().all()) menu->addAction(dock->toggleViewAction());
  add(menu, Action{"Restore default layout", {}, "", [this] { window_.docks().restore_default(); }});
}

void Menus::add_layers(QMenu* menu) {
  const auto add_layer = [&](const QString& text, const QString& key, const QString& tip, MapLayer layer,
                             Place place = in_toolbar) {
    add(menu, Switch{text, key, tip, window_.map().scene().layer(layer),
                     [this, layer](bool on) { window_.maps().set_layer(layer, on); }, place});
  };
  add_layer("Map", "M", "Walls, furniture and their joints", MapLayer::map);
  add_layer("Room", "Shift+M", "The room as a depth camera saw it (--room)", MapLayer::room, in_menu);
  add_layer("Objects", "O", "Boxes at the believed poses of objects", MapLayer::objects);
  add_layer("Labels", "L", "Names of objects", MapLayer::labels);
  add_layer("Cloud", "C", "The points measured in the selected scene", MapLayer::cloud);
  add_layer("Camera", "K", "Camera pose of the selected scene", MapLayer::camera);
  separate_tools();
  add_layer("Trajectory", "T", "Where the selected object has been until the selected time", MapLayer::trace,
            in_menu);
  add_layer("All cameras", "Shift+K", "Camera poses of all scenes", MapLayer::cameras, in_menu);
  add(menu, Action{"Measure", {"R"}, "Distance between two clicked points of the map", [this] {
                     window_.docks().show("tools3d");
                     window_.docks().map_tools().ruler()->toggle();
                   }});
}

void Menus::add_image_options(QMenu* menu) {
  SceneImage& image = window_.docks().image();
  add(menu, Switch{"Depth image", "D", "Depth instead of colour", false,
                   [&image](bool on) { image.show_depth(on); }, in_toolbar});
  add(menu, Switch{"Masks", "N", "Outlines of the objects in the image", true,
                   [&image](bool on) { image.show_masks(on); }});
  add(menu,
      Switch{"Pixel kinds", "I", "Tints the image: map-explained pixels, background, region of interest",
             false, [&image](bool on) { image.show_kinds(on); }});
}

void Menus::build_help_menu() {
  add(add_menu("&Help"),
      Action{"&Keys and mouse", {"F1", "?"}, "", [this] { ShortcutSheet(menus_, &window_).exec(); }});
}

void Menus::build_toolbar() {
  QToolBar* bar = window_.addToolBar("Tools");
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

void Menus::save_image() {
  const QString path = QFileDialog::getSaveFileName(&window_, "Save image", "browser.png", "Images (*.png)");
  if (path.isEmpty()) return;
  try {
    if (!window_.screenshot().save(path)) throw Error("cannot write the image", {path.toStdString(), 0, {}});
    window_.show_message("Saved " + path);
  } catch (const Error& error) {
    QMessageBox::warning(&window_, "No image", QString::fromUtf8(error.what()));
  }
}

// ---- The sheet of keys.

namespace {

using Line = std::pair<QString, QString>;

const QList<Line> kMouse = {{"Turn the map", "left drag"},
                            {"Shift the map", "middle drag, Shift + left drag"},
                            {"Zoom", "wheel, right drag"},
                            {"Point size", "Ctrl + wheel"},
                            {"Zoom in time", "wheel over the scenes"},
                            {"Select", "click in map, tree or image"}};

QString plain(QString text) {
  return text.remove('&').remove("…");
}

QString keys_of(const QAction& action) {
  QStringList keys;
  for (const QKeySequence& key : action.shortcuts()) keys << key.toString(QKeySequence::NativeText);
  return keys.join(" or ");
}

QList<Line> lines_of_menu(const QMenu& menu) {
  QList<Line> lines;
  for (const QAction* action : menu.actions())
    if (!action->shortcuts().isEmpty()) lines.append({plain(action->text()), keys_of(*action)});
  return lines;
}

int add_block(QGridLayout& grid, int column, int row, const QString& title, const QList<Line>& lines) {
  grid.addWidget(new QLabel("<b>" + title.toHtmlEscaped() + "</b>"), row++, column, 1, 2);
  for (const auto& [what, keys] : lines) {
    grid.addWidget(new QLabel(what), row, column);
    grid.addWidget(new QLabel(keys), row++, column + 1);
  }
  grid.addWidget(new QLabel, row++, column);
  return row;
}

}  // namespace

ShortcutSheet::ShortcutSheet(const QList<QMenu*>& menus, QWidget* parent) : QDialog(parent) {
  setWindowTitle("Keys and mouse");
  auto* grid = new QGridLayout(this);
  grid->setContentsMargins(20, 16, 20, 12);
  grid->setHorizontalSpacing(24);
  grid->setVerticalSpacing(4);
  std::array<int, 2> next_row = {0, 0};  // of the two columns
  const auto add = [&](const QString& title, const QList<Line>& lines) {
    const size_t side = next_row[0] <= next_row[1] ? 0 : 1;
    next_row[side] = add_block(*grid, static_cast<int>(side) * 2, next_row[side], title, lines);
  };
  for (const QMenu* menu : menus)
    if (const auto lines = lines_of_menu(*menu); !lines.isEmpty()) add(plain(menu->title()), lines);
  add("Mouse", kMouse);
}

QStringList ShortcutSheet::lines_of(const QList<QMenu*>& menus) {
  QStringList lines;
  for (const QMenu* menu : menus)
    for (const auto& [what, keys] : lines_of_menu(*menu)) lines << what + "\t" + keys;
  return lines;
}

}  // namespace loci::gui
