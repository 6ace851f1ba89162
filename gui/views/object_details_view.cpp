#include "gui/views/object_details_view.h"

#include <QHeaderView>
#include <QListWidget>
#include <QPainter>
#include <QScrollArea>
#include <QTableWidget>
#include <QTextBrowser>
#include <QVBoxLayout>
#include <algorithm>

#include "gui/models/answer_links.h"
#include "gui/text.h"
#include "gui/theme.h"

namespace loci::gui {
namespace {

constexpr int kImage = 76, kHistogramHeight = 62;

/// Bars from zero, the largest as high as the widget.
class HistogramWidget : public QWidget {
 public:
  HistogramWidget(Histogram histogram, QWidget* parent) : QWidget(parent), histogram_(std::move(histogram)) {
    setFixedHeight(kHistogramHeight);
    setToolTip(
        QString("%1, %2 bins").arg(QString::fromStdString(histogram_.title)).arg(histogram_.bins.size()));
  }

 protected:
  void paintEvent(QPaintEvent*) override {
    QPainter painter(this);
    const Theme theme = Theme::of(palette());
    const int title = fontMetrics().height() + 2;
    painter.setPen(theme.text);
    painter.drawText(
        QRect(0, 0, width(), title), Qt::AlignLeft | Qt::AlignVCenter,
        fontMetrics().elidedText(QString::fromStdString(histogram_.title), Qt::ElideMiddle, width()));
    double least = 0, most = 1e-12;
    for (const double bin : histogram_.bins) {
      least = std::min(least, bin);
      most = std::max(most, bin);
    }
    const double step = static_cast<double>(width()) / static_cast<double>(histogram_.bins.size());
    const double scale = (height() - title - 2) / (most - least), zero = height() - 1 + least * scale;
    for (size_t i = 0; i < histogram_.bins.size(); ++i)
      painter.fillRect(QRectF(static_cast<double>(i) * step, zero - histogram_.bins[i] * scale,
                              std::max(1.0, step - 1), histogram_.bins[i] * scale),
                       theme.accent);
    painter.setPen(theme.grid);
    painter.drawLine(QPointF(0, zero), QPointF(width(), zero));
  }

 private:
  Histogram histogram_;
};

}  // namespace

ObjectDetailsView::ObjectDetailsView(Browser& browser, QWidget* history, QWidget* parent)
    : QTabWidget(parent),
      browser_(browser),
      images_(new QListWidget(this)),
      annotations_(new QTableWidget(0, 3, this)),
      why_(new QTextBrowser(this)) {
  setDocumentMode(true);
  setUsesScrollButtons(false);
  setMinimumHeight(5 * fontMetrics().height());  // the pages scroll
  images_->setViewMode(QListView::IconMode);
  images_->setResizeMode(QListView::Adjust);
  images_->setMovement(QListView::Static);
  images_->setIconSize(QSize(kImage, kImage));
  images_->setFrameShape(QFrame::NoFrame);
  images_->setToolTip("The newest image from each side. Click one to go to its time");
  annotations_->setHorizontalHeaderLabels({"What", "Value", "Expert"});
  annotations_->setEditTriggers(QAbstractItemView::NoEditTriggers);
  annotations_->setSelectionBehavior(QAbstractItemView::SelectRows);
  annotations_->setShowGrid(false);
  annotations_->setFrameShape(QFrame::NoFrame);
  annotations_->verticalHeader()->hide();
  annotations_->verticalHeader()->setDefaultSectionSize(fontMetrics().height() + 6);
  annotations_->horizontalHeader()->setDefaultAlignment(Qt::AlignLeft | Qt::AlignVCenter);
  annotations_->horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
  annotations_->horizontalHeader()->setSectionResizeMode(1, QHeaderView::Stretch);
  why_->setOpenLinks(false);
  why_->setFrameShape(QFrame::NoFrame);
  auto* said = new QWidget;
  histograms_ = new QVBoxLayout;
  auto* said_layout = new QVBoxLayout(said);
  said_layout->setContentsMargins(0, 4, 0, 0);
  said_layout->addWidget(annotations_);
  said_layout->addLayout(histograms_);
  said_layout->addStretch();
  auto* area = new QScrollArea(this);
  area->setWidget(said);
  area->setWidgetResizable(true);
  area->setFrameShape(QFrame::NoFrame);
  addTab(history, "History");
  addTab(images_, "Images");
  addTab(area, "Said");
  addTab(why_, "Why");
  setTabToolTip(2, "What annotators said of it when it was seen last, and their histograms");
  setTabToolTip(3, "Why the memory believes this, with the evidence and what else was considered");
  connect(images_, &QListWidget::itemClicked, this, [this](const QListWidgetItem* item) {
    browser_.selection().set_time(item->data(Qt::UserRole).toLongLong());
  });
  connect(why_, &QTextBrowser::anchorClicked, this, [this](const QUrl& link) {
    if (link.toString().startsWith("object:"))
      browser_.selection().select_object(link.toString().mid(7).toLongLong());
  });
  connect(this, &QTabWidget::currentChanged, this, &ObjectDetailsView::refresh);
  connect(&browser_, &Browser::selected, this, &ObjectDetailsView::refresh);
  connect(&browser_, &Browser::belief_changed, this, &ObjectDetailsView::refresh);
}

void ObjectDetailsView::refresh() {
  const auto object = browser_.selection().object();
  if (currentIndex() == 0 || !isVisible()) return;
  if (!object || browser_.data() == nullptr) {
    ObjectDetails none;
    return show_details(none);
  }
  browser_.reader().read<ObjectDetails>(
      this, "details", Urgency::rest,
      [id = *object, time = browser_.selection().time()](const BrowserData& memory) {
        return memory.details(id, time);
      },
      [this](ObjectDetails& details) { show_details(details); });
}

void ObjectDetailsView::show_details(ObjectDetails& details) {
  details_ = std::move(details);
  const int zone = browser_.data() == nullptr ? 0 : browser_.data()->info().zone_minutes;
  images_->clear();
  for (const ObjectImage& one : details_.images) {
    const QImage image =
        image_of(one.image).scaled(kImage, kImage, Qt::KeepAspectRatio, Qt::SmoothTransformation);
    const QString text = time_text(one.time, zone).mid(11, 8) + "\n" + QString::fromStdString(one.side);
    auto* item = new QListWidgetItem(QIcon(QPixmap::fromImage(image)), text, images_);
    item->setData(Qt::UserRole, static_cast<qlonglong>(one.time));
  }
  if (details_.images.empty()) new QListWidgetItem("No images were kept of it.", images_);
  annotations_->setRowCount(static_cast<int>(details_.annotations.size()));
  for (int row = 0; row < annotations_->rowCount(); ++row) {
    const Annotation& said = details_.annotations[static_cast<size_t>(row)];
    QString expert = QString::fromStdString(said.expert.empty() ? "–" : said.expert);
    if (said.confidence) expert += ", " + percent_text(*said.confidence);
    const QString cells[] = {QString::fromStdString(said.type), QString::fromStdString(said.value), expert};
    for (int column = 0; column < 3; ++column) {
      auto* item = new QTableWidgetItem(cells[column]);
      item->setToolTip(cells[column]);
      annotations_->setItem(row, column, item);
    }
  }
  annotations_->setFixedHeight((annotations_->rowCount() + 1) * (fontMetrics().height() + 6) + 6);
  show_histograms();
  why_->setHtml("<p style='white-space:pre-wrap'>" + linked_text(QString::fromStdString(details_.why), {}) +
                "</p>");
}

void ObjectDetailsView::show_histograms() {
  while (QLayoutItem* item = histograms_->takeAt(0)) {
    delete item->widget();
    delete item;
  }
  for (const Histogram& histogram : details_.histograms)
    histograms_->addWidget(new HistogramWidget(histogram, this));
}

}  // namespace loci::gui
