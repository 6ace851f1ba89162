#pragma once

#include <QWidget>
#include <atomic>
#include <memory>
#include <vector>

#include "gui/core/widgets.h"
#include "gui/data/browser.h"
#include "memory/report/memory_statistics.h"

class QLabel;
class QScrollArea;
class QToolButton;

namespace loci::gui {

/// A chart with its title: lying bars with names and values beside them, or standing ones where the names are
/// short and many (hours).
class BarChart : public QWidget {
 public:
  explicit BarChart(memory::Chart chart, QWidget* parent = nullptr);

  QSize sizeHint() const override;
  QSize minimumSizeHint() const override;
  const memory::Chart& chart() const { return chart_; }

 protected:
  void paintEvent(QPaintEvent* event) override;

 private:
  bool stands() const;
  void paint_lying(QPainter& painter, double greatest) const;
  void paint_standing(QPainter& painter, double greatest) const;

  memory::Chart chart_;
};

class BarChart;

/// Numbers about the whole memory as bar charts; counted in the background when they are first shown.
class StatisticsView : public Page {
  Q_OBJECT

 public:
  explicit StatisticsView(Browser& browser, QWidget* parent = nullptr);
  ~StatisticsView() override;

  const std::vector<BarChart*>& charts() const { return bars_; }
  /// Writes the charts as an image or as a table. Error when it cannot.
  void save_png(const QString& path) const;
  void save_csv(const QString& path) const;

 protected:
  void came_to_front() override;

 private:
  void forget();
  void count();
  void show_charts(const std::vector<memory::Chart>& charts);
  void offer_saving(BarChart* bars, const memory::Chart& chart);
  void ask_and_save(const QString& name, const QString& filter,
                    void (StatisticsView::*save)(const QString&) const);

  Browser& browser_;
  QLabel* state_;
  QScrollArea* area_;
  std::vector<QToolButton*> savers_;
  std::vector<memory::Chart> charts_;
  std::vector<BarChart*> bars_;
  std::shared_ptr<std::atomic<bool>> stop_;  ///< set while something is counted
};

}  // namespace loci::gui
