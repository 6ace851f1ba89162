#pragma once

#include <QMainWindow>
#include <QStringList>
#include <functional>

#include "gui/browser.h"
#include "gui/views/map_view.h"

class QDockWidget;
class QLabel;

namespace loci {

class ObjectCard;
class ObjectsTree;
class QuestionBar;
class LogView;
class SceneImage;
class StatisticsView;
class TimeBar;

struct WindowOptions {
  MapBackend backend = MapBackend::widget;
  bool remember = true;  ///< layout and recent files between sessions
};

/// The browser's window: the views as docks around the map, linked by one Browser.
class MainWindow : public QMainWindow {
  Q_OBJECT

 public:
  /// Opens a memory by path; throws Error.
  using Opener = std::function<std::unique_ptr<BrowserData>(const std::string& path)>;

  MainWindow(Opener opener, const WindowOptions& options = {});
  ~MainWindow() override;

  /// Opens a file; a dialog says why it cannot be. The memory that was open stays then.
  bool open(const QString& path);
  void show_data(std::unique_ptr<BrowserData> memory);
  /// The window as a picture. Error when the 3D view stayed blank.
  QImage screenshot();
  MapView& map_view() { return *map_; }

  Browser& browser() { return browser_; }
  MapView& map() { return *map_; }
  ObjectsTree& tree() { return *tree_; }
  SceneImage& image() { return *image_; }
  TimeBar& time_bar() { return *time_; }
  ObjectCard& card() { return *card_; }
  QuestionBar& question_bar() { return *questions_; }
  StatisticsView& statistics() { return *statistics_; }
  LogView& log() { return *log_; }
  /// Brings a dock to the front by its name (objects, scene, selection, statistics, log, time). Error when
  /// there is none.
  void show_dock(const std::string& name);
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
  void build_time_menu();
  void build_select_menu();
  void build_view_menu();
  void build_help_menu();
  void build_toolbar();
  void default_layout();
  void refresh_title();
  void refresh_recent();
  void remember_file(const QString& path);
  void ask_for_file();
  void save_picture();
  void copy_card();
  void show_keys();
  void tell(const QString& message);

  Opener opener_;
  WindowOptions options_;
  Browser browser_;
  MapView* map_;
  ObjectsTree* tree_ = nullptr;
  SceneImage* image_ = nullptr;
  TimeBar* time_ = nullptr;
  ObjectCard* card_ = nullptr;
  QuestionBar* questions_ = nullptr;
  StatisticsView* statistics_ = nullptr;
  LogView* log_ = nullptr;
  QDockWidget* image_dock_ = nullptr;
  QMenu* recent_ = nullptr;
  QLabel* summary_ = nullptr;
  QList<QAction*> tools_;
  QByteArray default_state_;
};

}  // namespace loci
