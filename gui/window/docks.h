#pragma once

#include <QList>
#include <string>

#include "gui/data/browser.h"

class QDockWidget;
class QMainWindow;

namespace loci::gui {

class CompareView;
class IdentityView;
class LogView;
class MapTools;
class MapView;
class ObjectCard;
class ObjectsTree;
class SceneImage;
class SceneView;
class StatisticsView;
class TimeBar;

/// The views around the map, each in a dock of the window.
class Docks {
 public:
  Docks(QMainWindow& window, Browser& browser, MapView& map);

  ObjectsTree& tree() const { return *tree_; }
  MapTools& map_tools() const { return *map_tools_; }
  SceneView& scene_view() const { return *scene_view_; }
  SceneImage& image() const;
  TimeBar& time_bar() const { return *time_bar_; }
  ObjectCard& card() const { return *card_; }
  StatisticsView& statistics() const { return *statistics_; }
  LogView& log() const { return *log_; }
  CompareView& compare() const { return *compare_; }
  IdentityView& identity() const { return *identity_; }
  QList<QDockWidget*> all() const;

  /// Brings a dock to the front by its name (objects, scene, selection, compare, statistics, log, time).
  /// Error when there is none.
  void show(const std::string& name) const;
  /// Sizes and places as at the first start.
  void restore_default();
  /// Views read the browser until their end, and closing a tab shows the next one: docks end before it.
  void remove_all() const;

 private:
  QDockWidget* add(const QString& title, const QString& name, QWidget* widget, Qt::DockWidgetArea area);
  QDockWidget* find(const std::string& name) const;

  QMainWindow& window_;
  ObjectsTree* tree_;
  MapTools* map_tools_;
  SceneView* scene_view_;
  TimeBar* time_bar_;
  ObjectCard* card_;
  StatisticsView* statistics_;
  LogView* log_;
  CompareView* compare_;
  IdentityView* identity_;
  QByteArray default_state_;
};

}  // namespace loci::gui
