#include "gui/main_window.h"

#include <QCloseEvent>
#include <QDockWidget>
#include <QFileInfo>
#include <QLabel>
#include <QLayout>
#include <QMenuBar>
#include <QSettings>
#include <QStatusBar>
#include <QToolBar>

#include "gui/text.h"
#include "gui/views/compare_view.h"
#include "gui/views/identity_view.h"
#include "gui/views/log_view.h"
#include "gui/views/map_tools.h"
#include "gui/views/object_card.h"
#include "gui/views/objects_tree.h"
#include "gui/views/page.h"
#include "gui/views/question_bar.h"
#include "gui/views/scene_image.h"
#include "gui/views/scene_view.h"
#include "gui/views/statistics_view.h"
#include "gui/views/time_bar.h"
#include "gui/views/time_track.h"
#include "mapping/base/error.h"

namespace loci::gui {
namespace {

constexpr int kMessageMs = 8000;
const QSize kFirstSize(1280, 800);

}  // namespace

MainWindow::MainWindow(MemoryOpener opener, const WindowOptions& options)
    : options_(options),
      loader_(std::move(opener)),
      maps_(new MapPair(browser_, options.backend, this)),
      map_(&maps_->now()) {
  setAcceptDrops(true);
  setDockOptions(AnimatedDocks | AllowNestedDocks | AllowTabbedDocks);
  setCentralWidget(maps_);
  build_docks();
  build_file_menu();
  build_time_menu();
  build_edit_menu();
  build_select_menu();
  build_view_menu();
  build_help_menu();
  build_toolbar();
  build_questions();
  summary_ = new QLabel(this);
  statusBar()->addPermanentWidget(summary_);
  connect(&browser_, &Browser::opened, this, &MainWindow::refresh_title);
  connect(&browser_, &Browser::failed, this, &MainWindow::tell);
  connect(maps_, &MapPair::warned, this, &MainWindow::tell);
  connect(compare_, &CompareView::compared, this,
          [this] { maps_->show_other(compare_->beside(), compare_->shown()); });
  default_layout();
  layout()->activate();  // what the docks need is only known now
  resize(kFirstSize);
  default_layout();
  default_state_ = saveState();
  if (options_.remember) {
    const QSettings settings;
    restoreGeometry(settings.value("geometry").toByteArray());
    restoreState(settings.value("layout").toByteArray());
  }
  build_loading();
  refresh_recent();
  refresh_title();
}

MainWindow::~MainWindow() {
  disconnect(&browser_, nullptr, this, nullptr);
  // The views read the browser until their end, and a tab that goes shows the next one: they go first.
  for (QDockWidget* dock : findChildren<QDockWidget*>()) delete dock;
  delete takeCentralWidget();
  delete questions_;
}

QDockWidget* MainWindow::add_dock(const QString& title, const QString& name, QWidget* widget,
                                  Qt::DockWidgetArea area) {
  auto* dock = new QDockWidget(title, this);
  dock->setObjectName(name);
  dock->setWidget(widget);
  addDockWidget(area, dock);
  if (auto* page = dynamic_cast<Page*>(widget))
    connect(dock, &QDockWidget::visibilityChanged, page, &Page::set_looked_at);
  return dock;
}

void MainWindow::build_docks() {
  tree_ = new ObjectsTree(browser_, this);
  scene_view_ = new SceneView(browser_, this);
  card_ = new ObjectCard(browser_, this);
  time_ = new TimeBar(browser_, this);
  setCorner(Qt::BottomLeftCorner, Qt::BottomDockWidgetArea);
  setCorner(Qt::BottomRightCorner, Qt::BottomDockWidgetArea);
  setTabPosition(Qt::LeftDockWidgetArea, QTabWidget::North);
  QDockWidget* objects = add_dock("Places and objects", "objects", tree_, Qt::LeftDockWidgetArea);
  map_tools_ = new MapTools(browser_, *map_, this);
  tabifyDockWidget(objects, add_dock("Map tools", "tools3d", map_tools_, Qt::LeftDockWidgetArea));
  objects->raise();
  image_dock_ = add_dock("Scene", "scene", scene_view_, Qt::RightDockWidgetArea);
  fill_corner();
  add_dock("Time", "time", time_, Qt::BottomDockWidgetArea);
}

SceneImage& MainWindow::image() {
  return scene_view_->image();
}

void MainWindow::build_questions() {
  questions_ = new QuestionBar(browser_, this);
  QList<QAction*> actions;
  for (const QMenu* menu : menus())
    for (QAction* action : menu->actions())
      if (!action->isSeparator() && action->menu() == nullptr) actions << action;
  questions_->set_actions(actions);
  if (options_.remember) {
    questions_->set_asked(QSettings().value("asked").toStringList());
    connect(questions_, &QuestionBar::asked_changed, this,
            [this] { QSettings().setValue("asked", questions_->asked()); });
  }
  map_->installEventFilter(this);
}

/// The question bar stays over the map.
bool MainWindow::eventFilter(QObject* watched, QEvent* event) {
  if (watched == map_ && (event->type() == QEvent::Resize || event->type() == QEvent::Move))
    questions_->place_in(QRect(map_->mapTo(this, QPoint(0, 0)), map_->size()));
  return QMainWindow::eventFilter(watched, event);
}

/// The views below the image share one place, with tabs.
void MainWindow::fill_corner() {
  statistics_ = new StatisticsView(browser_, this);
  log_ = new LogView(browser_, this);
  compare_ = new CompareView(browser_, this);
  identity_ = new IdentityView(browser_, this);
  setTabPosition(Qt::RightDockWidgetArea, QTabWidget::North);
  QDockWidget* first = add_dock("Selection", "selection", card_, Qt::RightDockWidgetArea);
  for (QDockWidget* dock : {add_dock("Identity", "identity", identity_, Qt::RightDockWidgetArea),
                            add_dock("Compare", "compare", compare_, Qt::RightDockWidgetArea),
                            add_dock("Statistics", "statistics", statistics_, Qt::RightDockWidgetArea),
                            add_dock("Log", "log", log_, Qt::RightDockWidgetArea)})
    tabifyDockWidget(first, dock);
  first->raise();
}

void MainWindow::show_dock(const std::string& name) {
  auto* dock = findChild<QDockWidget*>(QString::fromStdString(name));
  if (dock == nullptr) {
    QStringList names;
    for (const auto* other : findChildren<QDockWidget*>()) names << other->objectName();
    throw Error("there is no dock '" + name + "'", {}, "docks are " + names.join(", ").toStdString());
  }
  dock->show();
  dock->raise();
}

void MainWindow::default_layout() {
  if (!default_state_.isEmpty()) restoreState(default_state_);
  const auto dock = [this](const char* name) { return findChild<QDockWidget*>(name); };
  resizeDocks({dock("objects"), dock("scene")}, {318, 360}, Qt::Horizontal);
  resizeDocks({dock("scene"), dock("selection")}, {230, 330}, Qt::Vertical);
  resizeDocks({dock("time")}, {200}, Qt::Vertical);
}

void MainWindow::refresh_title() {
  const BrowserData* memory = browser_.data();
  if (memory == nullptr) {
    setWindowTitle("loci");
    summary_->setText("Open a memory with Ctrl+O, or drop one here");
    return;
  }
  const MemoryInfo& info = memory->info();
  setWindowTitle(QString("%1 – schema %2%3 – loci")
                     .arg(QFileInfo(QString::fromStdString(info.path)).fileName(),
                          QString::fromStdString(info.schema), can_edit() ? "" : ", read-only file"));
  summary_->setText(QString::fromStdString(info.summary));
  summary_->setToolTip(QString::fromStdString(info.path));
}

void MainWindow::show_data(std::unique_ptr<BrowserData> memory) {
  show_memory(std::move(memory));
}

void MainWindow::show_memory(std::shared_ptr<const BrowserData> memory) {
  edits_.set_memory(memory == nullptr ? QString() : QString::fromStdString(memory->info().path));
  if (memory == nullptr) loader_.follow({});
  browser_.open(std::move(memory));
  time_->track()->setFocus();
}

QImage MainWindow::screenshot() {
  map_->image();  // Throws when nothing was drawn.
  if (maps_->is_pair()) maps_->then()->image();
  return grab().toImage();
}

void MainWindow::tell(const QString& message) {
  statusBar()->showMessage(message, kMessageMs);
}

void MainWindow::closeEvent(QCloseEvent* event) {
  if (options_.remember) {
    QSettings settings;
    settings.setValue("geometry", saveGeometry());
    settings.setValue("layout", saveState());
  }
  QMainWindow::closeEvent(event);
}

}  // namespace loci::gui
