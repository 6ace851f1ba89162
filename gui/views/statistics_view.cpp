#include "gui/views/statistics_view.h"

#include <QAction>
#include <QBuffer>
#include <QFileDialog>
#include <QHBoxLayout>
#include <QLabel>
#include <QPainter>
#include <QPixmap>
#include <QScrollArea>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>

#include "gui/core/background.h"
#include "gui/core/theme.h"
#include "mapping/base/error.h"
#include "mapping/base/files.h"
#include "memory/store/store.h"

namespace loci::gui {
namespace {

constexpr int kChartTitle = 22;
constexpr int kBarRow = 18;
constexpr int kStandingHeight = 80;
constexpr int kStandingFrom = 12;  // bars
constexpr int kValueWidth = 52;

/// Types are known by the end of their name.
QString label(const std::string& name) {
  return QString::fromStdString(name).section('.', -1);
}

QString number(double value) {
  return QString::number(value, 'g', 8);
}

}  // namespace

BarChart::BarChart(memory::Chart chart, QWidget* parent) : QWidget(parent), chart_(std::move(chart)) {
  setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
}

bool BarChart::stands() const {
  return chart_.bars.size() >= kStandingFrom &&
         std::all_of(chart_.bars.begin(), chart_.bars.end(),
                     [](const auto& bar) { return bar.first.size() <= 2; });
}

QSize BarChart::sizeHint() const {
  const int rows = std::max(1, static_cast<int>(chart_.bars.size()));
  return {320, kChartTitle + (stands() ? kStandingHeight + kBarRow : rows * kBarRow) + 8};
}

QSize BarChart::minimumSizeHint() const {
  return {240, sizeHint().height()};
}

void BarChart::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  const Theme theme = Theme::of(palette());
  const QFont bold = bold_font(font());
  painter.setFont(bold);
  painter.setPen(theme.text);
  const QString title = QString::fromStdString(chart_.title);
  painter.drawText(QRect(0, 0, width(), kChartTitle), Qt::AlignVCenter | Qt::AlignLeft, title);
  const int title_width = QFontMetrics(bold).horizontalAdvance(title);
  painter.setFont(font());
  painter.setPen(theme.muted);
  const QString unit = QString::fromStdString(chart_.unit);
  if (title_width + 12 + fontMetrics().horizontalAdvance(unit) < width())
    painter.drawText(QRect(0, 0, width(), kChartTitle), Qt::AlignVCenter | Qt::AlignRight, unit);
  double greatest = 0;
  for (const auto& [name, value] : chart_.bars) greatest = std::max(greatest, value);
  if (greatest <= 0)
    painter.drawText(QRect(0, kChartTitle, width(), kBarRow), Qt::AlignVCenter | Qt::AlignLeft,
                     "nothing to count");
  else if (stands())
    paint_standing(painter, greatest);
  else
    paint_lying(painter, greatest);
}

void BarChart::paint_lying(QPainter& painter, double greatest) const {
  const Theme theme = Theme::of(palette());
  int names = 0;
  for (const auto& [name, value] : chart_.bars)
    names = std::max(names, fontMetrics().horizontalAdvance(label(name)));
  names = std::min(names, width() * 2 / 5);
  const double room = width() - names - 8 - kValueWidth;
  int y = kChartTitle;
  for (const auto& [name, value] : chart_.bars) {
    painter.setPen(theme.text);
    painter.drawText(QRect(0, y, names, kBarRow), Qt::AlignVCenter | Qt::AlignLeft,
                     fontMetrics().elidedText(label(name), Qt::ElideMiddle, names));
    const double length = room * value / greatest;
    painter.fillRect(QRectF(names + 8, y + 3, std::max(length, value > 0 ? 1.0 : 0.0), kBarRow - 6),
                     theme.accent);
    painter.setPen(theme.muted);
    painter.drawText(QRectF(names + 8 + length + 5, y, kValueWidth, kBarRow),
                     Qt::AlignVCenter | Qt::AlignLeft, number(value));
    y += kBarRow;
  }
}

void BarChart::paint_standing(QPainter& painter, double greatest) const {
  const Theme theme = Theme::of(palette());
  const double step = static_cast<double>(width()) / static_cast<double>(chart_.bars.size());
  const double floor = kChartTitle + kStandingHeight;
  const QFont small = small_font(font());
  painter.setFont(small);
  painter.setPen(theme.grid);
  painter.drawLine(QPointF(0, floor), QPointF(width(), floor));
  double free_from = 0;  // where the next name has room
  for (size_t i = 0; i < chart_.bars.size(); ++i) {
    const auto& [name, value] = chart_.bars[i];
    const double x = step * static_cast<double>(i);
    const double height = (kStandingHeight - 14) * value / greatest;
    painter.fillRect(QRectF(x + 1, floor - height, step - 2, height), theme.accent);
    painter.setPen(theme.muted);
    if (value > 0)
      painter.drawText(QRectF(x - 10, floor - height - 14, step + 20, 14), Qt::AlignCenter, number(value));
    const double wide = QFontMetricsF(small).horizontalAdvance(label(name)) + 4;
    if (x + step / 2 - wide / 2 < free_from) continue;
    painter.drawText(QRectF(x - 10, floor + 2, step + 20, kBarRow - 2), Qt::AlignCenter, label(name));
    free_from = x + step / 2 + wide / 2;
  }
}

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
  if (is_in_front()) count();
}

void StatisticsView::came_to_front() {
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
  add("Save this chart as CSV…", ".csv", "Tables (*.csv)",
      [chart] { return memory::statistics_csv({chart}); });
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
