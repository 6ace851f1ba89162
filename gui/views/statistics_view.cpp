#include "gui/views/statistics_view.h"

#include <QAction>
#include <QBuffer>
#include <QFileDialog>
#include <QHBoxLayout>
#include <QLabel>
#include <QPixmap>
#include <QScrollArea>
#include <QToolButton>
#include <QVBoxLayout>

#include "gui/background.h"
#include "gui/views/bar_chart.h"
#include "mapping/base/error.h"
#include "mapping/base/files.h"
#include "memory/store/store.h"

namespace loci::gui {
namespace {

class Stoppable : public Progress {
 public:
  explicit Stoppable(std::shared_ptr<std::atomic<bool>> stop) : stop_(std::move(stop)) {}
  bool update(double, std::string_view) override { return !*stop_; }

 private:
  std::shared_ptr<std::atomic<bool>> stop_;
};

std::string png_of(QWidget& widget) {
  QByteArray bytes;
  QBuffer buffer(&bytes);
  buffer.open(QIODevice::WriteOnly);
  if (!widget.grab().save(&buffer, "PNG")) throw Error("the image could not be encoded", {});
  return {bytes.constData(), static_cast<size_t>(bytes.size())};
}

}  // namespace

StatisticsView::StatisticsView(Browser& browser, QWidget* parent)
    : Page(parent), browser_(browser), state_(new QLabel(this)), area_(new QScrollArea(this)) {
  area_->setWidgetResizable(true);
  area_->setFrameShape(QFrame::NoFrame);
  area_->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  auto* tools = new QHBoxLayout;
  tools->addWidget(state_, 1);
  const auto add = [&](const QString& text, const QString& name, const QString& filter, auto save) {
    auto* button = new QToolButton(this);
    button->setText(text);
    button->setToolTip("Save all charts as " + filter);
    connect(button, &QToolButton::clicked, this,
            [this, name, filter, save] { ask_and_save(name, filter, save); });
    tools->addWidget(button);
    savers_.push_back(button);
  };
  add("CSV…", "statistics.csv", "Tables (*.csv)", &StatisticsView::save_csv);
  add("PNG…", "statistics.png", "Images (*.png)", &StatisticsView::save_png);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(8, 6, 8, 6);
  layout->addLayout(tools);
  layout->addWidget(area_, 1);
  connect(&browser_, &Browser::opened, this, &StatisticsView::forget);
  forget();
}

StatisticsView::~StatisticsView() {
  if (stop_) *stop_ = true;
}

void StatisticsView::forget() {
  if (stop_) *stop_ = true;
  stop_.reset();
  show_charts({});
  if (is_looked_at()) count();
}

void StatisticsView::look() {
  if (charts_.empty() && !stop_) count();
}

void StatisticsView::count() {
  if (browser_.data() == nullptr) return;
  state_->setText("Counting…");
  stop_ = std::make_shared<std::atomic<bool>>(false);
  in_background<std::vector<memory::Chart>>(
      this,
      [path = browser_.data()->info().path, stop = stop_] {
        Stoppable progress(stop);
        return memory_statistics(memory::Store::open_read(path), progress);
      },
      [this, stop = stop_](const std::vector<memory::Chart>& charts) {
        if (!*stop) show_charts(charts);
      },
      [this, stop = stop_](const std::exception_ptr& error) {
        if (!*stop) Q_EMIT browser_.failed(reason_of(error));
      });
}

void StatisticsView::show_charts(const std::vector<memory::Chart>& charts) {
  charts_ = charts;
  bars_.clear();
  auto* page = new QWidget;
  auto* layout = new QVBoxLayout(page);
  layout->setContentsMargins(0, 0, 6, 0);
  layout->setSpacing(10);
  for (const memory::Chart& chart : charts_) {
    bars_.push_back(new BarChart(chart, page));
    offer_saving(bars_.back(), chart);
    layout->addWidget(bars_.back());
  }
  layout->addStretch();
  area_->setWidget(page);
  state_->setText(charts_.empty() ? "Open a memory to see its numbers." : "The whole memory");
  for (QToolButton* button : savers_) button->setEnabled(!charts_.empty());
}

/// Each chart alone, from its menu.
void StatisticsView::offer_saving(BarChart* bars, const memory::Chart& chart) {
  bars->setContextMenuPolicy(Qt::ActionsContextMenu);
  bars->setToolTip("The right button saves this chart alone");
  const QString name = QString::fromStdString(chart.title).toLower().replace(' ', '_');
  const auto add = [&](const QString& text, const QString& ending, const QString& filter, auto content) {
    auto* action = new QAction(text, bars);
    connect(action, &QAction::triggered, this, [this, name, ending, filter, content] {
      const QString path = QFileDialog::getSaveFileName(this, "Save chart", name + ending, filter);
      if (path.isEmpty()) return;
      try {
        write_file_atomically(path.toStdString(), content());
      } catch (const Error& error) {
        Q_EMIT browser_.failed(QString::fromUtf8(error.what()));
      }
    });
    bars->addAction(action);
  };
  add("Save this chart as PNG…", ".png", "Images (*.png)", [bars] { return png_of(*bars); });
  add("Save this chart as CSV…", ".csv", "Tables (*.csv)", [chart] { return statistics_csv({chart}); });
}

void StatisticsView::save_png(const QString& path) const {
  write_file_atomically(path.toStdString(), png_of(*area_->widget()));
}

void StatisticsView::save_csv(const QString& path) const {
  write_file_atomically(path.toStdString(), statistics_csv(charts_));
}

void StatisticsView::ask_and_save(const QString& name, const QString& filter,
                                  void (StatisticsView::*save)(const QString&) const) {
  const QString path = QFileDialog::getSaveFileName(this, "Save statistics", name, filter);
  if (path.isEmpty()) return;
  try {
    (this->*save)(path);
  } catch (const Error& error) {
    Q_EMIT browser_.failed(QString::fromUtf8(error.what()));
  }
}

}  // namespace loci::gui
