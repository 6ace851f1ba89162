#include "gui/window/docks.h"

#include <QDockWidget>
#include <QLayout>
#include <QMainWindow>

#include "gui/views/compare_view.h"
#include "gui/views/identity_view.h"
#include "gui/views/log_view.h"
#include "gui/views/map/map_tools.h"
#include "gui/views/object_card.h"
#include "gui/views/objects_tree.h"
#include "gui/views/scene_view.h"
#include "gui/views/statistics_view.h"
#include "gui/views/timeline/time_bar.h"
#include "mapping/base/error.h"

namespace loci::gui {
namespace {

const QSize kFirstSize(1280, 800);

}  // namespace

Docks::Docks(QMainWindow& window, Browser& browser, MapView& map)
    : window_(window),
      tree_(new ObjectsTree(browser, &window)),
      map_tools_(new MapTools(browser, map, &window)),
      scene_view_(new SceneView(browser, &window)),
      time_bar_(new TimeBar(browser, &window)),
      card_(new ObjectCard(browser, &window)),
      statistics_(new StatisticsView(browser, &window)),
      log_(new LogView(browser, &window)),
      compare_(new CompareView(browser, &window)),
      identity_(new IdentityView(browser, &window)) {
  window_.setDockOptions(QMainWindow::AnimatedDocks | QMainWindow::AllowNestedDocks |
                         QMainWindow::AllowTabbedDocks);
  window_.setCorner(Qt::BottomLeftCorner, Qt::BottomDockWidgetArea);
  window_.setCorner(Qt::BottomRightCorner, Qt::BottomDockWidgetArea);
  window_.setTabPosition(Qt::LeftDockWidgetArea, QTabWidget::North);
  window_.setTabPosition(Qt::RightDockWidgetArea, QTabWidget::North);
  QDockWidget* objects = add("Places and objects", "objects", tree_, Qt::LeftDockWidgetArea);
  window_.tabifyDockWidget(objects, add("Map tools", "tools3d", map_tools_, Qt::LeftDockWidgetArea));
  objects->raise();
  add("Scene", "scene", scene_view_, Qt::RightDockWidgetArea);
  QDockWidget* selection = add("Selection", "selection", card_, Qt::RightDockWidgetArea);
  for (QDockWidget* dock : {add("Identity", "identity", identity_, Qt::RightDockWidgetArea),
                            add("Compare", "compare", compare_, Qt::RightDockWidgetArea),
                            add("Statistics", "statistics", statistics_, Qt::RightDockWidgetArea),
                            add("Log", "log", log_, Qt::RightDockWidgetArea)})
    window_.tabifyDockWidget(selection, dock);
  selection->raise();
  add("Time", "time", time_bar_, Qt::BottomDockWidgetArea);
}

QDockWidget* Docks::add(const QString& title, const QString& name, QWidget* widget, Qt::DockWidgetArea area) {
  auto* dock = new QDockWidget(title, &window_);
  dock->setObjectName(name);
  dock->setWidget(widget);
  window_.addDockWidget(area, dock);
  if (auto* page = dynamic_cast<Page*>(widget))
    QObject::connect(dock, &QDockWidget::visibilityChanged, page, &Page::set_in_front);
  return dock;
}

SceneImage& Docks::image() const {
  return scene_view_->image();
}

QList<QDockWidget*> Docks::all() const {
  return window_.findChildren<QDockWidget*>();
}

QDockWidget* Docks::find(const std::string& name) const {
  return window_.findChild<QDockWidget*>(QString::fromStdString(name));
}

void Docks::show(const std::string& name) const {
  QDockWidget* dock = find(name);
  if (dock == nullptr) {
    QStringList names;
    for (const QDockWidget* other : all()) names << other->objectName();
    throw Error("there is no dock '" + name + "'", {}, "docks are " + names.join(", ").toStdString());
  }
  dock->show();
  dock->raise();
}

void Docks::restore_default() {
  const auto resize = [this] {
    window_.resizeDocks({find("objects"), find("scene")}, {318, 390}, Qt::Horizontal);
    window_.resizeDocks({find("scene"), find("selection")}, {230, 330}, Qt::Vertical);
    window_.resizeDocks({find("time")}, {200}, Qt::Vertical);
  };
  if (!default_state_.isEmpty()) {
    window_.restoreState(default_state_);
    return resize();
  }
  resize();
  window_.layout()->activate();  // what the docks need is only known now
  window_.resize(kFirstSize);
  resize();
  default_state_ = window_.saveState();
}

void Docks::remove_all() const {
  for (QDockWidget* dock : all()) delete dock;
}

}  // namespace loci::gui
