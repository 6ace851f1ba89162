#include "gui/window/main_window.h"

#include <QAction>
#include <QDropEvent>
#include <QFileInfo>
#include <QLabel>
#include <QMimeData>
#include <QSettings>
#include <QStatusBar>

#include "gui/views/compare_view.h"
#include "gui/views/question_bar.h"
#include "gui/views/timeline/time_bar.h"
#include "gui/window/exporter.h"
#include "gui/window/menus.h"
#include "gui/window/object_editor.h"

namespace loci::gui {
namespace {

constexpr int kMessageMs = 8000;

QLabel* add_summary(QMainWindow& window) {
  auto* label = new QLabel(&window);
  window.statusBar()->addPermanentWidget(label);
  return label;
}

}  // namespace

MainWindow::MainWindow(MemoryOpener opener, const WindowOptions& options)
    : options_(options),
      summary_(add_summary(*this)),
      files_(std::move(opener), browser_, *this, options.remember),
      maps_(new MapPair(browser_, options.backend, this)),
      docks_(*this, browser_, maps_->now()),
      editor_(new ObjectEditor(browser_, edits_, this)),
      exporter_(new Exporter(browser_, this)),
      menus_(std::make_unique<Menus>(*this)),
      questions_(new QuestionBar(browser_, this)) {
  setAcceptDrops(true);
  setCentralWidget(maps_);
  build_questions();
  connect_parts();
  restore_layout();
  refresh_title();
}

MainWindow::~MainWindow() {
  disconnect(&browser_, nullptr, this, nullptr);
  docks_.remove_all();
  delete takeCentralWidget();
  delete questions_;
}

void MainWindow::build_questions() {
  questions_->set_actions(menus_->actions());
  if (options_.remember) {
    questions_->set_asked(QSettings().value("asked").toStringList());
    connect(questions_, &QuestionBar::asked_changed, this,
            [this] { QSettings().setValue("asked", questions_->asked()); });
  }
  map().installEventFilter(this);
}

void MainWindow::connect_parts() {
  connect(&browser_, &Browser::opened, this, &MainWindow::refresh_title);
  connect(&browser_, &Browser::failed, this, &MainWindow::show_message);
  connect(maps_, &MapPair::warned, this, &MainWindow::show_message);
  connect(&files_, &FileOpener::message, this, &MainWindow::show_message);
  connect(&files_, &FileOpener::opened, this, &MainWindow::show_data);
  connect(editor_, &ObjectEditor::message, this, &MainWindow::show_message);
  connect(exporter_, &Exporter::message, this, &MainWindow::show_message);
  connect(&edits_, &EditHistory::failed, &browser_, &Browser::failed);
  connect(&edits_, &EditHistory::written, this, [this](const QString& what) {
    show_message(what);
    files_.loader().check();
  });
  CompareView& compare = docks_.compare();
  connect(&compare, &CompareView::compared, this,
          [this, &compare] { maps_->show_other(compare.beside(), compare.shown()); });
}

void MainWindow::restore_layout() {
  docks_.restore_default();
  if (!options_.remember) return;
  const QSettings settings;
  restoreGeometry(settings.value("geometry").toByteArray());
  restoreState(settings.value("layout").toByteArray());
}

/// The question bar stays over the map.
bool MainWindow::eventFilter(QObject* watched, QEvent* event) {
  if (watched == &map() && (event->type() == QEvent::Resize || event->type() == QEvent::Move))
    questions_->place_in(QRect(map().mapTo(this, QPoint(0, 0)), map().size()));
  return QMainWindow::eventFilter(watched, event);
}

void MainWindow::refresh_title() {
  const OpenMemory* memory = browser_.data();
  if (memory == nullptr) {
    setWindowTitle("loci");
    summary_->setText("Open a memory with Ctrl+O, or drop one here");
    return;
  }
  const MemoryInfo& info = memory->info();
  setWindowTitle(QString("%1 – schema %2%3 – loci")
                     .arg(QFileInfo(QString::fromStdString(info.path)).fileName(),
                          QString::fromStdString(info.schema),
                          editor_->can_edit() ? "" : ", read-only file"));
  summary_->setText(QString::fromStdString(info.summary));
  summary_->setToolTip(QString::fromStdString(info.path));
}

void MainWindow::show_data(MemoryLoader::Result memory) {
  edits_.set_memory(memory == nullptr ? QString() : QString::fromStdString(memory->info().path));
  if (memory == nullptr) files_.loader().follow({});
  browser_.open(std::move(memory));
  docks_.time_bar().take_focus();
}

QImage MainWindow::screenshot() {
  map().image();  // throws when nothing was drawn
  if (maps_->is_pair()) maps_->then()->image();
  return grab().toImage();
}

void MainWindow::show_message(const QString& text) {
  statusBar()->showMessage(text, kMessageMs);
}

void MainWindow::dragEnterEvent(QDragEnterEvent* event) {
  if (event->mimeData()->hasUrls() && event->mimeData()->urls().front().isLocalFile())
    event->acceptProposedAction();
}

void MainWindow::dropEvent(QDropEvent* event) {
  event->acceptProposedAction();
  open(event->mimeData()->urls().front().toLocalFile());
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
