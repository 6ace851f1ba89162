#include "gui/views/log_view.h"

#include <QClipboard>
#include <QGuiApplication>
#include <QHeaderView>
#include <QPlainTextEdit>
#include <QTableView>
#include <QToolButton>
#include <QVBoxLayout>

#include "gui/core/background.h"
#include "gui/models/table_models.h"

namespace loci::gui {
namespace {
constexpr int kDetailLines = 5;
}

LogView::LogView(Browser& browser, QWidget* parent)
    : Page(parent),
      browser_(browser),
      model_(new LogModel(browser, this)),
      table_(new QTableView(this)),
      details_(new QPlainTextEdit(this)),
      copy_(new QToolButton(this)) {
  table_->setModel(model_);
  style_table(*table_);
  table_->setSelectionMode(QAbstractItemView::SingleSelection);
  table_->horizontalHeader()->setStretchLastSection(true);
  for (const int column : {LogModel::time_column, LogModel::what_column})
    table_->horizontalHeader()->setSectionResizeMode(column, QHeaderView::ResizeToContents);
  table_->setHorizontalScrollMode(QAbstractItemView::ScrollPerPixel);
  details_->setReadOnly(true);
  details_->setFixedHeight(fontMetrics().lineSpacing() * kDetailLines + 12);
  details_->setPlaceholderText("Click a line to see all of it.");
  copy_->setText("Copy details");
  copy_->setEnabled(false);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(8, 6, 8, 6);
  layout->addWidget(table_, 1);
  layout->addWidget(details_);
  layout->addWidget(copy_, 0, Qt::AlignRight);
  connect(copy_, &QToolButton::clicked, this, &LogView::copy_details);
  connect(table_->selectionModel(), &QItemSelectionModel::currentRowChanged, this, &LogView::show_details);
  connect(model_, &QAbstractItemModel::modelReset, this, &LogView::show_details);
  connect(table_, &QTableView::clicked, this, [this](const QModelIndex& index) {
    if (const auto scene = model_->entry(index.row()).scene) browser_.selection().set_time(*scene);
  });
  connect(&browser_, &Browser::failed, model_, &LogModel::add_problem);
  connect(&browser_, &Browser::opened, this, &LogView::forget);
  connect(&browser_, &Browser::belief_changed, this, &LogView::follow_scene);
  connect(model_, &QAbstractItemModel::modelReset, this, &LogView::follow_scene);
}

void LogView::forget() {
  loaded_ = false;
  followed_ = 0;
  model_->set_memory_log({});
  if (is_in_front()) load();
}

void LogView::came_to_front() {
  if (!loaded_) load();
  follow_scene();
}

void LogView::load() {
  const auto memory = browser_.shared_data();
  if (memory == nullptr) return;
  loaded_ = true;
  in_background<std::vector<LogEntry>>(
      this, [path = memory->info().path] { return memory_log(path); },
      [this, memory](std::vector<LogEntry>& entries) {
        if (memory.get() == browser_.data()) model_->set_memory_log(std::move(entries));
      },
      [this](const std::exception_ptr& error) { Q_EMIT browser_.failed(reason_of(error)); });
}

void LogView::show_details() {
  const QModelIndex index = table_->currentIndex();
  copy_->setEnabled(index.isValid());
  if (!index.isValid()) return details_->clear();
  const LogEntry& entry = model_->entry(index.row());
  const QString text = QString::fromStdString(entry.details);
  details_->setPlainText(text);
  if (entry.scene_id == 0 || browser_.data() == nullptr) return;
  in_background<std::string>(
      this,
      [path = browser_.data()->info().path, scene = entry.scene_id] { return annotator_log(path, scene); },
      [this, text](const std::string& log) {  // unless another line is shown by now
        if (details_->toPlainText() == text)
          details_->setPlainText(QString::fromStdString(log) + "\n\n" + text);
      },
      [this](const std::exception_ptr& error) { Q_EMIT browser_.failed(reason_of(error)); });
}

void LogView::follow_scene() {
  const memory::SceneRow* scene = browser_.scene();
  if (!is_in_front() || scene == nullptr || scene->time == followed_) return;
  for (int row = 0; row < model_->rowCount(); ++row)
    if (model_->entry(row).scene == scene->time) {
      followed_ = scene->time;
      const QModelIndex line = model_->index(row, LogModel::what_column);
      table_->setCurrentIndex(line);
      table_->scrollTo(line, QAbstractItemView::PositionAtCenter);
      return;
    }
}

void LogView::copy_details() {
  QGuiApplication::clipboard()->setText(details_->toPlainText());
}

}  // namespace loci::gui
