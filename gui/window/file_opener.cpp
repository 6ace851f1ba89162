#include "gui/window/file_opener.h"

#include <QFileDialog>
#include <QFileInfo>
#include <QMainWindow>
#include <QMenu>
#include <QMessageBox>
#include <QProgressBar>
#include <QPushButton>
#include <QSettings>
#include <QStatusBar>
#include <QToolButton>

#include "gui/core/background.h"
#include "gui/data/memory_log.h"

namespace loci::gui {
namespace {

constexpr int kRecentFiles = 8;
constexpr int kProgressWidth = 180;
constexpr int kReadingShownMs = 400;
constexpr int kProgressSteps = 1000;

}  // namespace

FileOpener::FileOpener(MemoryOpener opener, Browser& browser, QMainWindow& window, bool remember)
    : QObject(&window),
      loader_(std::move(opener)),
      browser_(browser),
      window_(window),
      remember_(remember),
      progress_(new QProgressBar(&window)),
      cancel_(new QToolButton(&window)) {
  add_status_widgets();
  reading_.setSingleShot(true);
  reading_.setInterval(kReadingShownMs);
  connect(&reading_, &QTimer::timeout, this, &FileOpener::show_reading);
  connect(&browser_.reader(), &ReadQueue::waiting_changed, this, [this] {
    if (!progress_->isHidden())
      show_reading();
    else if (!reading_.isActive() && browser_.reader().waiting() > 0)
      reading_.start();
  });
  connect(&loader_, &MemoryLoader::progressed, this, [this](double fraction, const QString& text) {
    progress_->setValue(static_cast<int>(fraction * kProgressSteps));
    progress_->setFormat(text);
  });
  connect(&loader_, &MemoryLoader::finished, this, [this] {
    progress_->hide();
    cancel_->hide();
  });
  connect(&loader_, &MemoryLoader::loaded, this, &FileOpener::take);
  connect(&loader_, &MemoryLoader::failed, this,
          [this](const QString& path, const QString& reason, bool again) {
            if (again)
              Q_EMIT browser_.failed(reason);  // the next attempt may succeed
            else
              explain_failure(path, reason);
          });
}

void FileOpener::add_status_widgets() {
  progress_->setRange(0, kProgressSteps);
  progress_->setFixedWidth(kProgressWidth);
  progress_->setFixedHeight(window_.fontMetrics().height() + 2);
  cancel_->setText("Cancel");
  cancel_->setAutoRaise(true);
  for (QWidget* widget : std::initializer_list<QWidget*>{progress_, cancel_}) {
    window_.statusBar()->addPermanentWidget(widget);
    widget->hide();
  }
  connect(cancel_, &QToolButton::clicked, this, [this] {
    if (loader_.is_loading())
      loader_.cancel();
    else
      browser_.reader().cancel();
  });
}

/// Reading for the views is shown only when it takes long.
void FileOpener::show_reading() {
  if (loader_.is_loading()) return;
  const bool waits = browser_.reader().waiting() > 0;
  progress_->setVisible(waits);
  cancel_->setVisible(waits);
  progress_->setRange(0, 0);
  progress_->setFormat("reading");
}

void FileOpener::open(const QString& path, const std::function<void()>& then) {
  then_ = then;
  loader_.load(path);
  progress_->setRange(0, kProgressSteps);
  progress_->setValue(0);
  progress_->setFormat("opening");
  progress_->show();
  cancel_->show();
}

void FileOpener::take(const QString& path, const MemoryLoader::Result& memory, bool again) {
  if (again) return browser_.renew(memory);
  const auto then = std::exchange(then_, {});
  Q_EMIT opened(memory);
  remember_file(path);
  loader_.follow(path, memory);
  if (then) then();
}

void FileOpener::explain_failure(const QString& path, const QString& reason) {
  QMessageBox box(QMessageBox::Warning, "This memory cannot be opened", reason, QMessageBox::Close, &window_);
  box.setInformativeText("The open memory stays. A check reads the whole file and reports its problems.");
  box.setTextInteractionFlags(Qt::TextSelectableByMouse);
  const QPushButton* check = box.addButton("Check the file", QMessageBox::ActionRole);
  box.exec();
  if (box.clickedButton() == check) verify(path);
}

void FileOpener::verify(const QString& path) {
  Q_EMIT message("Checking " + path + "…");
  in_background<std::string>(
      this,
      [path] {
        NoProgress progress;
        return verify_memory(path.toStdString(), progress);
      },
      [this, path](const std::string& found) {
        QMessageBox box(QMessageBox::Information, "Check of " + QFileInfo(path).fileName(),
                        QString::fromStdString(found), QMessageBox::Ok, &window_);
        box.setTextInteractionFlags(Qt::TextSelectableByMouse);
        box.exec();
      },
      [this](const std::exception_ptr& error) { Q_EMIT browser_.failed(reason_of(error)); });
}

void FileOpener::ask_for_file() {
  const QString path =
      QFileDialog::getOpenFileName(&window_, "Open a memory", {}, "Memories (*.loci);;All files (*)");
  if (!path.isEmpty()) open(path);
}

void FileOpener::remember_file(const QString& path) {
  if (!remember_) return;
  QSettings settings;
  QStringList files = settings.value("recent").toStringList();
  const QString absolute = QFileInfo(path).absoluteFilePath();
  files.removeAll(absolute);
  files.prepend(absolute);
  settings.setValue("recent", QStringList(files.mid(0, kRecentFiles)));
  fill_recent_menu();
}

void FileOpener::set_recent_menu(QMenu* menu) {
  recent_ = menu;
  fill_recent_menu();
}

void FileOpener::fill_recent_menu() {
  if (recent_ == nullptr) return;
  recent_->clear();
  if (remember_)
    for (const QString& path : QSettings().value("recent").toStringList())
      recent_->addAction(path, this, [this, path] { open(path); });
  recent_->setEnabled(!recent_->isEmpty());
}

}  // namespace loci::gui
