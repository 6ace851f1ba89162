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

namespace loci::gui {
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

const BelievedObject* MainWindow::edited_object() {
  const BelievedObject* object = browser_.selected_object();
  if (!can_edit())
    tell("This file is read-only");
  else if (object == nullptr)
    tell("Choose an object first");
  return can_edit() ? object : nullptr;
}

void MainWindow::edit_selected(const QString& title, const std::string& key, const QString& now) {
  const BelievedObject* object = edited_object();
  if (object == nullptr) return;
  const std::string about = "object_" + std::to_string(object->id);
  bool taken = false;
  const QString name = QString::fromStdString(about);
  const QString value =
      QInputDialog::getText(this, title, QString("%1 of %2 (empty takes it back):").arg(title, name),
                            QLineEdit::Normal, now == name ? QString() : now, &taken);
  if (taken) edits_.say(about, key, value.trimmed().toStdString());
}

void MainWindow::rename_selected() {
  const QString place = QString::fromStdString(browser_.selection().place());
  if (place.isEmpty()) {
    const BelievedObject* object = browser_.selected_object();
    return edit_selected("Name", "alias",
                         object == nullptr ? QString() : QString::fromStdString(object->name));
  }
  if (!can_edit()) return tell("This file is read-only");
  bool taken = false;
  const QString name =
      QInputDialog::getText(this, "Name", QString("Name of %1 (empty takes it back):").arg(place),
                            QLineEdit::Normal, place, &taken);
  if (!taken || name.trimmed() == place) return;
  // What is chosen stays chosen by its new name.
  auto* until_written = new QObject(this);
  connect(&edits_, &EditHistory::written, until_written, [this, name, until_written] {
    if (!name.trimmed().isEmpty()) browser_.selection().select_place(name.trimmed().toStdString());
    until_written->deleteLater();
  });
  connect(&edits_, &EditHistory::failed, until_written, [until_written] { until_written->deleteLater(); });
  edits_.name_part(place.toStdString(), name.trimmed().toStdString());
}

void MainWindow::merge_selected() {
  const BelievedObject* object = edited_object();
  if (object == nullptr) return;
  QStringList names;
  std::vector<int64_t> ids;
  for (const BelievedObject& other : browser_.belief().objects)
    if (other.id != object->id) {
      names << QString("%1 (%2%3)")
                   .arg(QString::fromStdString(other.name), other.color_name.c_str(),
                        other.place.empty() ? "" : ", " + QString::fromStdString(other.place));
      ids.push_back(other.id);
    }
  if (names.isEmpty()) return tell("There is no other object at this time");
  bool taken = false;
  const QString chosen = QInputDialog::getItem(
      this, "The same thing", QString("%1 is the same thing as:").arg(QString::fromStdString(object->name)),
      names, 0, false, &taken);
  if (taken) edits_.merge(object->id, ids[static_cast<size_t>(names.indexOf(chosen))]);
}

void MainWindow::split_selected() {
  if (const BelievedObject* object = edited_object()) edits_.split(object->id, browser_.selection().time());
}

void MainWindow::label_selected() {
  const BelievedObject* object = edited_object();
  const SceneEntry* scene = browser_.scene();
  const SceneContent* content = browser_.moment().content.get();
  if (object == nullptr || scene == nullptr || content == nullptr) return;
  for (const ImageBox& box : content->boxes) {
    if (box.object != object->id) continue;
    bool taken = false;
    const QString label =
        QInputDialog::getText(this, "Label", "What this is (empty takes it back):", QLineEdit::Normal,
                              QString::fromStdString(object->class_name), &taken);
    if (taken) edits_.label(scene->id, box.number, label.trimmed().toStdString());
    return;
  }
  tell("The chosen object is not in this image");
}

QString MainWindow::asked_joint() {
  const mapping::World* world = browser_.data() == nullptr ? nullptr : browser_.data()->world();
  if (!can_edit() || world == nullptr) {
    tell(world == nullptr ? "This memory has no map" : "This file is read-only");
    return {};
  }
  QStringList joints;
  int present = 0;
  for (const mapping::Joint& joint : world->joints) {
    if (joint.child == browser_.selection().place()) present = joints.size();
    joints << QString::fromStdString(joint.name);
  }
  bool taken = false;
  const QString joint =
      QInputDialog::getItem(this, "Joint", "Which joint is wrong:", joints, present, false, &taken);
  return taken ? joint : QString();
}

void MainWindow::name_joint() {
  const QString joint = asked_joint();
  if (joint.isEmpty()) return;
  bool taken = false;
  const QString name =
      QInputDialog::getText(this, "Name of a joint", QString("Name of %1 (empty takes it back):").arg(joint),
                            QLineEdit::Normal, joint, &taken);
  if (taken && name.trimmed() != joint) edits_.name_part(joint.toStdString(), name.trimmed().toStdString());
}

void MainWindow::correct_joint() {
  const QString joint = asked_joint();
  if (joint.isEmpty()) return;
  bool taken = false;
  const QString type = QInputDialog::getItem(
      this, "Joint", joint + " is:", {"fixed", "revolute", "continuous", "prismatic"}, 0, false, &taken);
  if (taken) edits_.joint(joint.toStdString(), type.toStdString());
}

}  // namespace loci::gui
