// Opening, following, checking and editing memory files.

#include <QAction>
#include <QDropEvent>
#include <QFileDialog>
#include <QFileInfo>
#include <QInputDialog>
#include <QLabel>
#include <QMessageBox>
#include <QMimeData>
#include <QProgressBar>
#include <QPushButton>
#include <QSettings>
#include <QStatusBar>
#include <QToolButton>

#include "gui/background.h"
#include "gui/data/memory_verify.h"
#include "gui/main_window.h"

namespace loci {
namespace {

constexpr int kRecentFiles = 8;
constexpr int kProgressWidth = 180;
constexpr int kReadingShownMs = 400;

}  // namespace

void MainWindow::build_loading() {
  progress_ = new QProgressBar(this);
  progress_->setRange(0, 1000);
  progress_->setFixedWidth(kProgressWidth);
  progress_->setFixedHeight(fontMetrics().height() + 2);
  cancel_ = new QToolButton(this);
  cancel_->setText("Cancel");
  cancel_->setAutoRaise(true);
  for (QWidget* widget : std::initializer_list<QWidget*>{progress_, cancel_}) {
    statusBar()->addPermanentWidget(widget);
    widget->hide();
  }
  connect(cancel_, &QToolButton::clicked, this, [this] {
    if (loader_.is_loading())
      loader_.cancel();
    else
      browser_.reader().cancel();
  });
  reading_.setSingleShot(true);
  reading_.setInterval(kReadingShownMs);
  connect(&reading_, &QTimer::timeout, this, &MainWindow::show_reading);
  connect(&browser_.reader(), &MemoryReader::waiting_changed, this, [this] {
    if (!progress_->isHidden())
      show_reading();
    else if (!reading_.isActive() && browser_.reader().waiting() > 0)
      reading_.start();
  });
  connect(&loader_, &MemoryLoader::progressed, this, [this](double fraction, const QString& text) {
    progress_->setValue(static_cast<int>(fraction * 1000));
    progress_->setFormat(text);
  });
  connect(&loader_, &MemoryLoader::finished, this, [this] {
    progress_->hide();
    cancel_->hide();
  });
  connect(&loader_, &MemoryLoader::loaded, this, &MainWindow::take_loaded);
  connect(&loader_, &MemoryLoader::failed, this,
          [this](const QString& path, const QString& reason, bool again) {
            if (again)
              Q_EMIT browser_.failed(reason);  // it may be readable at the next look
            else
              explain_failure(path, reason);
          });
  connect(&edits_, &EditHistory::failed, &browser_, &Browser::failed);
  connect(&edits_, &EditHistory::written, this, [this](const QString& what) {
    tell(what);
    loader_.check();
  });
}

/// What is read for the views is only told when it takes long.
void MainWindow::show_reading() {
  if (loader_.is_loading()) return;
  const size_t waiting = browser_.reader().waiting();
  progress_->setVisible(waiting > 0);
  cancel_->setVisible(waiting > 0);
  progress_->setRange(0, 0);
  progress_->setFormat("reading");
}

void MainWindow::open(const QString& path, const std::function<void()>& then) {
  opened_then_ = then;
  loader_.load(path);
  progress_->setRange(0, 1000);
  progress_->setValue(0);
  progress_->setFormat("opening");
  progress_->show();
  cancel_->show();
}

void MainWindow::take_loaded(const QString& path, const MemoryLoader::Result& memory, bool again) {
  if (again) {
    browser_.renew(memory);
    return;
  }
  const auto then = opened_then_;
  opened_then_ = {};
  show_memory(memory);
  remember_file(path);
  loader_.follow(path, memory);
  if (then) then();
}

void MainWindow::explain_failure(const QString& path, const QString& reason) {
  QMessageBox box(QMessageBox::Warning, "This memory cannot be opened", reason, QMessageBox::Close, this);
  box.setInformativeText("What was open stays. A check reads the whole file and says what is wrong with it.");
  box.setTextInteractionFlags(Qt::TextSelectableByMouse);
  const QPushButton* check = box.addButton("Check the file", QMessageBox::ActionRole);
  box.exec();
  if (box.clickedButton() == check) check_file(path);
}

void MainWindow::check_file(const QString& path) {
  tell("Checking " + path + "…");
  in_background<std::string>(
      this,
      [path] {
        NoProgress progress;
        return verify_memory(path.toStdString(), progress);
      },
      [this, path](const std::string& found) {
        QMessageBox box(QMessageBox::Information, "Check of " + QFileInfo(path).fileName(),
                        QString::fromStdString(found), QMessageBox::Ok, this);
        box.setTextInteractionFlags(Qt::TextSelectableByMouse);
        box.exec();
      },
      [this](const std::exception_ptr& error) { Q_EMIT browser_.failed(reason_of(error)); });
}

void MainWindow::ask_for_file() {
  const QString path =
      QFileDialog::getOpenFileName(this, "Open a memory", QString(), "Memories (*.loci);;All files (*)");
  if (!path.isEmpty()) open(path);
}

void MainWindow::remember_file(const QString& path) {
  if (!options_.remember) return;
  QSettings settings;
  QStringList files = settings.value("recent").toStringList();
  const QString absolute = QFileInfo(path).absoluteFilePath();
  files.removeAll(absolute);
  files.prepend(absolute);
  settings.setValue("recent", QStringList(files.mid(0, kRecentFiles)));
  refresh_recent();
}

void MainWindow::dragEnterEvent(QDragEnterEvent* event) {
  if (event->mimeData()->hasUrls() && event->mimeData()->urls().front().isLocalFile())
    event->acceptProposedAction();
}

void MainWindow::dropEvent(QDropEvent* event) {
  event->acceptProposedAction();
  open(event->mimeData()->urls().front().toLocalFile());
}

bool MainWindow::can_edit() const {
  return browser_.data() != nullptr &&
         QFileInfo(QString::fromStdString(browser_.data()->info().path)).isWritable();
}

void MainWindow::edit_selected(const QString& title, const std::string& key, const QString& now) {
  if (!can_edit()) return tell("This file is read-only");
  const BelievedObject* object = browser_.selected_object();
  if (object == nullptr) return tell("Choose an object first");
  const std::string about = "object_" + std::to_string(object->id);
  bool taken = false;
  const QString name = QString::fromStdString(about);
  const QString value =
      QInputDialog::getText(this, title, QString("%1 of %2 (empty takes it back):").arg(title, name),
                            QLineEdit::Normal, now == name ? QString() : now, &taken);
  if (taken) edits_.edit(about, key, value.trimmed().toStdString());
}

}  // namespace loci
