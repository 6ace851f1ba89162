#pragma once

#include <QDockWidget>
#include <QMainWindow>
#include <QStringList>
#include <QTimer>
#include <functional>

#include "gui/browser.h"
#include "gui/edit_history.h"
#include "gui/memory_loader.h"
#include "gui/views/map_pair.h"

class QLabel;
class QProgressBar;
class QToolButton;

namespace loci::gui {

class ObjectCard;
class ObjectsTree;
class QuestionBar;
class CompareView;
class IdentityView;
class LogView;
class MapTools;
class SceneImage;
class SceneView;
class StatisticsView;
class TimeBar;

struct WindowOptions {
  MapBackend backend = MapBackend::widget;
  bool remember = true;  ///< layout and recent files from one start to the next
};

/// The browser's window: the views as docks around the map, linked by one Browser.
class MainWindow : public QMainWindow {
  Q_OBJECT

 public:
  MainWindow(MemoryOpener opener, const WindowOptions& options = {});
  ~MainWindow() override;

  /// Opens a file in the background and follows it; `then` runs when it is shown. A dialog says why it cannot
  /// be opened, and offers to check it; the memory that was open stays then.
  void open(const QString& path, const std::function<void()>& then = {});
  void show_data(std::unique_ptr<BrowserData> memory);
  /// The window as an image. Error when the 3D view stayed blank.
  QImage screenshot();
  MapView& map_view() { return *map_; }

  Browser& browser() { return browser_; }
  MapView& map() { return *map_; }
  MapPair& maps() { return *maps_; }
  ObjectsTree& tree() { return *tree_; }
  MapTools& map_tools() { return *map_tools_; }
  SceneImage& image();
  SceneView& scene_view() { return *scene_view_; }
  TimeBar& time_bar() { return *time_; }
  ObjectCard& card() { return *card_; }
  QuestionBar& question_bar() { return *questions_; }
  StatisticsView& statistics() { return *statistics_; }
  LogView& log() { return *log_; }
  CompareView& compare() { return *compare_; }
  IdentityView& identity() { return *identity_; }
  MemoryLoader& loader() { return loader_; }
  EditHistory& edits() { return edits_; }
  /// Brings a dock to the front by its name (objects, scene, selection, compare, statistics, log, time).
  /// Error when there is none.
  void show_dock(const std::string& name);
  QList<QDockWidget*> docks() const { return findChildren<QDockWidget*>(); }
  QList<QMenu*> menus() const;

 protected:
  void dragEnterEvent(QDragEnterEvent* event) override;
  void dropEvent(QDropEvent* event) override;
  void closeEvent(QCloseEvent* event) override;
  bool eventFilter(QObject* watched, QEvent* event) override;

 private:
  struct Key {
    QString text;
    QList<QKeySequence> keys;
    QString tip;
  };
  QAction* add_action(QMenu* menu, const Key& key, const std::function<void()>& run);
  QAction* add_check(QMenu* menu, const Key& key, bool on, const std::function<void(bool)>& run);
  void fill_corner();
  QDockWidget* add_dock(const QString& title, const QString& name, QWidget* widget, Qt::DockWidgetArea area);
  void build_docks();
  void build_questions();
  void build_file_menu();
  void build_export_menu(QMenu* file);
  /// Asks for a file and writes it in the background.
  void export_to(const QString& name, const QString& filter,
                 const std::function<std::string(const std::string& path)>& content);
  void export_table();
  void export_images();
  void export_scene();
  void export_cloud();
  void export_map();
  void export_report();
  void build_edit_menu();
  void build_loading();
  void show_reading();
  void build_time_menu();
  void build_select_menu();
  void build_view_menu();
  void build_help_menu();
  void build_toolbar();
  void default_layout();
  void show_memory(std::shared_ptr<const BrowserData> memory);
  void take_loaded(const QString& path, const MemoryLoader::Result& memory, bool again);
  void explain_failure(const QString& path, const QString& reason);
  void check_file(const QString& path);
  bool can_edit() const;
  /// The chosen object, when it can be edited; else says why not.
  const BelievedObject* edited_object();
  void edit_selected(const QString& title, const std::string& key, const QString& now);
  void rename_selected();
  void merge_selected();
  void split_selected();
  void label_selected();
  /// Which joint of the map somebody wants to correct; empty = none.
  QString asked_joint();
  void name_joint();
  void correct_joint();
  void refresh_title();
  void refresh_recent();
  void remember_file(const QString& path);
  void ask_for_file();
  void save_image();
  void copy_card();
  void show_keys();
  void tell(const QString& message);

  WindowOptions options_;
  MemoryLoader loader_;
  EditHistory edits_;
  Browser browser_;
  MapPair* maps_;  ///< the map, and the one that it is compared with
  MapView* map_;
  ObjectsTree* tree_ = nullptr;
  MapTools* map_tools_ = nullptr;
  SceneView* scene_view_ = nullptr;
  TimeBar* time_ = nullptr;
  ObjectCard* card_ = nullptr;
  QuestionBar* questions_ = nullptr;
  StatisticsView* statistics_ = nullptr;
  LogView* log_ = nullptr;
  CompareView* compare_ = nullptr;
  IdentityView* identity_ = nullptr;
  QProgressBar* progress_ = nullptr;
  QToolButton* cancel_ = nullptr;
  QTimer reading_;  ///< until it is told that something is read
  std::function<void()> opened_then_;
  QDockWidget* image_dock_ = nullptr;
  QMenu* recent_ = nullptr;
  QLabel* summary_ = nullptr;
  QList<QAction*> tools_;
  QByteArray default_state_;
};

}  // namespace loci::gui
