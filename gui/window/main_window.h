#pragma once

#include <QMainWindow>
#include <functional>
#include <memory>

#include "gui/data/browser.h"
#include "gui/data/edit_history.h"
#include "gui/views/map/map_pair.h"
#include "gui/window/docks.h"
#include "gui/window/file_opener.h"

class QLabel;

namespace loci::gui {

class Exporter;
class Menus;
class ObjectEditor;
class QuestionBar;

struct WindowOptions {
  MapBackend backend = MapBackend::widget;
  bool remember = true;  ///< layout, questions and recent files from one start to the next
};

/// The browser's window: the map, the other views as docks around it, the question bar over it, linked by one
/// Browser.
class MainWindow : public QMainWindow {
  Q_OBJECT

 public:
  MainWindow(MemoryOpener opener, const WindowOptions& options = {});
  ~MainWindow() override;

  /// See FileOpener::open().
  void open(const QString& path, const std::function<void()>& then = {}) { files_.open(path, then); }
  /// Shows a memory; nullptr closes the open one.
  void show_data(MemoryLoader::Result memory);
  /// The window as an image. Error when the 3D view stayed blank.
  QImage screenshot();
  /// A line in the status bar.
  void show_message(const QString& text);

  Browser& browser() { return browser_; }
  EditHistory& edits() { return edits_; }
  FileOpener& files() { return files_; }
  MapPair& maps() { return *maps_; }
  MapView& map() { return maps_->now(); }
  Docks& docks() { return docks_; }
  QuestionBar& question_bar() { return *questions_; }
  ObjectEditor& editor() { return *editor_; }
  Exporter& exporter() { return *exporter_; }
  Menus& menus() { return *menus_; }

 protected:
  void dragEnterEvent(QDragEnterEvent* event) override;
  void dropEvent(QDropEvent* event) override;
  void closeEvent(QCloseEvent* event) override;
  bool eventFilter(QObject* watched, QEvent* event) override;

 private:
  void build_questions();
  void connect_parts();
  void restore_layout();
  void refresh_title();

  WindowOptions options_;
  QLabel* summary_;  ///< of the open memory, in the status bar
  EditHistory edits_;
  Browser browser_;
  FileOpener files_;
  MapPair* maps_;  ///< the map, and the one that it is compared with
  Docks docks_;
  ObjectEditor* editor_;
  Exporter* exporter_;
  std::unique_ptr<Menus> menus_;
  QuestionBar* questions_;
};

}  // namespace loci::gui
