#include "gui/views/object_card.h"

#include <QFormLayout>
#include <QHeaderView>
#include <QLabel>
#include <QListWidget>
#include <QPainter>
#include <QProgressBar>
#include <QScrollArea>
#include <QTableView>
#include <QTableWidget>
#include <QTextBrowser>
#include <QVBoxLayout>
#include <algorithm>

#include "gui/core/text.h"
#include "gui/core/theme.h"
#include "gui/core/widgets.h"
#include "gui/models/question_text.h"
#include "gui/models/table_models.h"
#include "memory/questions/replies/answer_format.h"

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
  annotations_->setHorizontalHeaderLabels({"What", "Value", "Annotator"});
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
  auto* page = new QWidget;
  histograms_ = new QVBoxLayout;
  auto* page_layout = new QVBoxLayout(page);
  page_layout->setContentsMargins(0, 4, 0, 0);
  page_layout->addWidget(annotations_);
  page_layout->addLayout(histograms_);
  page_layout->addStretch();
  auto* area = new QScrollArea(this);
  area->setWidget(page);
  area->setWidgetResizable(true);
  area->setFrameShape(QFrame::NoFrame);
  addTab(history, "History");
  addTab(images_, "Images");
  addTab(area, "Annotations");
  addTab(why_, "Why");
  setTabToolTip(2, "Annotations of the last observation, and their histograms");
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
      [id = *object, time = browser_.selection().time()](const OpenMemory& memory) {
        return memory.details(id, time);
      },
      [this](ObjectDetails& details) { show_details(details); });
}

void ObjectDetailsView::show_details(ObjectDetails& details) {
  details_ = std::move(details);
  const TimeZone zone = browser_.data() == nullptr ? TimeZone() : browser_.data()->info().zone;
  images_->clear();
  for (const ObjectImage& one : details_.images) {
    const QImage image =
        image_of(one.image).scaled(kImage, kImage, Qt::KeepAspectRatio, Qt::SmoothTransformation);
    const QString text = time_text(one.time, zone).mid(11, 8) + "\n" + QString::fromStdString(one.side);
    auto* item = new QListWidgetItem(QIcon(QPixmap::fromImage(image)), text, images_);
    item->setData(Qt::UserRole, static_cast<qlonglong>(one.time));
  }
  if (details_.images.empty()) new QListWidgetItem("No images are stored of it.", images_);
  annotations_->setRowCount(static_cast<int>(details_.annotations.size()));
  for (int row = 0; row < annotations_->rowCount(); ++row) {
    const Annotation& said = details_.annotations[static_cast<size_t>(row)];
    QString annotator = QString::fromStdString(said.annotator.empty() ? "–" : said.annotator);
    if (said.confidence) annotator += ", " + percent_text(*said.confidence);
    const QString cells[] = {QString::fromStdString(said.type), QString::fromStdString(said.value),
                             annotator};
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

namespace {

constexpr int kImageSide = 64;
constexpr const char* kState = "State";
constexpr double kCertain = 0.995;  ///< shown as 100 %

QLabel* selectable_label(QWidget* parent) {
  auto* label = new QLabel(parent);
  label->setTextInteractionFlags(Qt::TextSelectableByMouse);
  label->setWordWrap(true);
  return label;
}

}  // namespace

ObjectCard::ObjectCard(Browser& browser, QWidget* parent)
    : QWidget(parent),
      browser_(browser),
      model_(new HistoryModel(browser, this)),
      image_(new QLabel(this)),
      title_(selectable_label(this)),
      hint_(new QLabel(this)),
      rows_(new QWidget(this)),
      probability_(new QProgressBar(this)),
      history_(new QTableView(this)),
      pages_(new ObjectDetailsView(browser, history_, this)) {
  image_->setFixedSize(kImageSide, kImageSide);
  image_->setAlignment(Qt::AlignCenter);
  title_->setFont(bold_font(scaled_font(font(), 1.25)));
  hint_->setWordWrap(true);
  build_rows();
  history_->setModel(model_);
  style_table(*history_);
  history_->setFrameShape(QFrame::NoFrame);
  history_->setMinimumHeight(2 * (fontMetrics().height() + 6));
  history_->setHorizontalScrollMode(QAbstractItemView::ScrollPerPixel);
  history_->horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
  history_->horizontalHeader()->setSectionResizeMode(HistoryModel::place_column, QHeaderView::Stretch);
  history_->setToolTip("Click a line to go to its time");

  auto* head = new QHBoxLayout;
  head->setSpacing(10);
  auto* words = new QVBoxLayout;
  words->setSpacing(2);
  words->addWidget(title_);
  words->addWidget(hint_);
  words->addStretch();
  head->addWidget(image_, 0, Qt::AlignTop);
  head->addLayout(words, 1);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(8, 8, 8, 8);
  layout->setSpacing(8);
  layout->addLayout(head);
  layout->addWidget(rows_);
  layout->addWidget(pages_, 1);

  connect(history_, &QTableView::clicked, this, [this](const QModelIndex& index) {
    browser_.selection().set_time(index.data(HistoryModel::time_role).toLongLong());
  });
  connect(&browser_, &Browser::selected, this, &ObjectCard::refresh);
  connect(&browser_, &Browser::belief_changed, this, &ObjectCard::refresh);
  refresh();
}

void ObjectCard::build_rows() {
  auto* form = new QFormLayout(rows_);
  form->setContentsMargins(0, 0, 0, 0);
  form->setHorizontalSpacing(12);
  form->setVerticalSpacing(2);
  form->setLabelAlignment(Qt::AlignLeft);
  for (const char* name : {"Place", kState, "Last seen", "Colour", "Size", "Position"}) {
    auto* value = selectable_label(rows_);
    form->addRow(name, value);
    if (QString(name) == kState) value->setToolTip(kStatusHelp);
    values_.emplace_back(name, value);
  }
  probability_->setRange(0, 1000);
  probability_->setTextVisible(true);
  probability_->setFixedHeight(fontMetrics().height() + 4);
  probability_->setToolTip("How probable it is that what was seen last still is at this place");
  form->addRow("Still there", probability_);
}

QString ObjectCard::title() const {
  return title_->text();
}

QString ObjectCard::text() const {
  QString all = title_->text();
  if (rows_->isHidden()) return all;
  for (const auto& [name, label] : values_) all += "\n" + name + ": " + label->text();
  return all + "\nStill there: " + probability_->text();
}

void ObjectCard::refresh() {
  const SelectionModel& selection = browser_.selection();
  if (const BelievedObject* object = browser_.selected_object()) return show_object(*object);
  if (selection.object())
    return show_nothing(QString("object_%1").arg(*selection.object()), "Not known yet at this time.");
  if (!selection.place().empty()) return show_place(selection.place());
  show_nothing("", browser_.data() == nullptr ? "" : "Click an object in the tree, the map or the image.");
}

void ObjectCard::show_place(const std::string& place) {
  int there = 0;
  for (const BelievedObject& object : browser_.belief().objects)
    there += browser_.belief().place_of(object) == place && object.status != memory::ObjectStatus::gone;
  const QString title = QString::fromStdString(place);
  const QString objects = there == 0 ? QString("Nothing is believed to be here.")
                                     : QString("%1 object%2 here.").arg(there).arg(there == 1 ? "" : "s");
  show_nothing(title, objects);
  const TimeNs time = browser_.selection().time();
  browser_.reader().read<PlaceDetails>(
      this, "place", Urgency::selection,
      [place, time](const OpenMemory& memory) { return memory.place_details(place, time); },
      [this, place, title, objects, time](const PlaceDetails& details) {
        if (browser_.selection().place() != place || browser_.data() == nullptr) return;
        QStringList lines = {objects};
        if (details.height) lines << QString("Height: %1 cm").arg(*details.height * 100, 0, 'f', 0);
        lines << (details.last_look
                      ? QString("Last look: %1 (%2 before), at %3 of it")
                            .arg(time_text(*details.last_look, browser_.data()->info().zone),
                                 duration_text(*details.last_look, time), percent_text(details.seen))
                      : QString("Not looked at yet."));
        show_nothing(title, lines.join("\n"));
      });
}

void ObjectCard::show_nothing(const QString& title, const QString& hint) {
  title_->setText(title);
  title_->setVisible(!title.isEmpty());
  hint_->setText(hint);
  image_->hide();
  rows_->hide();
  pages_->setVisible(browser_.selection().object().has_value());
}

void ObjectCard::show_object(const BelievedObject& object) {
  const TimeZone& zone = browser_.data()->info().zone;
  const Theme theme = Theme::of(palette());
  title_->setVisible(true);
  const Belief& belief = browser_.belief();
  const std::string id = memory::object_name(object.object), name = belief.name_of(object);
  const std::string class_name = belief.names->class_of(object.object);
  const std::string owner = belief.names->owner_of(object.object);
  title_->setText(QString::fromStdString(name));
  QStringList facts;
  if (name != id) facts << QString::fromStdString(id);
  if (!class_name.empty()) facts << QString::fromStdString(class_name);
  if (!owner.empty()) facts << "of " + QString::fromStdString(owner);
  hint_->setText(facts.join(", "));
  const QString place = QString::fromStdString(belief.place_of(object));
  const QString at = place.isEmpty() ? "unknown" : place;
  QString seen = "never";
  if (object.last_seen) {
    seen = time_text(*object.last_seen, zone);
    const QString ago = duration_text(*object.last_seen, browser_.selection().time());
    if (object.status != memory::ObjectStatus::seen) seen += QString(" (%1 before)").arg(ago);
  }
  QString position = "unknown";
  if (object.position) {
    const Vector3d& p = *object.position;
    position = QString("%1, %2, %3 m").arg(p.x(), 0, 'f', 2).arg(p.y(), 0, 'f', 2).arg(p.z(), 0, 'f', 2);
  }
  const std::vector<QString> values = {
      object.status == memory::ObjectStatus::gone ? QString("gone, last on %1").arg(at) : at,
      state_text(object.status),
      seen,
      QString::fromStdString(object.color.value_or("unknown")),
      object.size ? QString::fromStdString(memory::format::size_text(*object.size)) : "unknown",
      position};
  for (size_t i = 0; i < values.size(); ++i) values_[i].second->setText(values[i]);
  probability_->setValue(static_cast<int>(object.probability * 1000));
  probability_->setFormat(percent_text(object.probability));
  QPalette colors = palette();
  colors.setColor(QPalette::Highlight, theme.of_status(object.status));
  colors.setColor(QPalette::HighlightedText,
                  colors.color(QPalette::Highlight).lightness() > 140 ? Qt::black : Qt::white);
  probability_->setPalette(colors);
  rows_->show();
  pages_->show();
  show_image();
  show_certainty(state_text(object.status));
}

void ObjectCard::show_certainty(const QString& state) {
  const int64_t object = *browser_.selection().object();
  browser_.reader().read<double>(
      this, "certainty", Urgency::selection,
      [object, time = browser_.selection().time(), known_at = browser_.selection().known_at()](
          const OpenMemory& memory) { return memory.certainty_of_last_sighting(object, time, known_at); },
      [this, object, state](const double& certainty) {
        if (certainty >= kCertain || browser_.selection().object() != object) return;
        for (auto& [name, label] : values_)
          if (name == kState) label->setText(state + "; identity " + percent_text(certainty) + " sure");
      });
}

void ObjectCard::show_image() {
  const int64_t object = *browser_.selection().object();
  if (object != imaged_) image_->hide();  // of another object
  browser_.reader().read<cv::Mat>(
      this, "image", Urgency::selection,
      [object, time = browser_.selection().time()](const OpenMemory& memory) {
        return memory.image(object, time);
      },
      [this, object](const cv::Mat& pixels) {
        imaged_ = object;
        const QImage image = image_of(pixels);
        image_->setVisible(!image.isNull() && !rows_->isHidden());
        if (!image.isNull())
          image_->setPixmap(QPixmap::fromImage(
              image.scaled(image_->size(), Qt::KeepAspectRatio, Qt::SmoothTransformation)));
      });
}

}  // namespace loci::gui
