#include "gui/views/object_card.h"

#include <QFormLayout>
#include <QHeaderView>
#include <QLabel>
#include <QProgressBar>
#include <QTableView>
#include <QVBoxLayout>

#include "gui/models/history_model.h"
#include "gui/presence_help.h"
#include "gui/text.h"
#include "gui/theme.h"
#include "gui/views/object_details_view.h"

namespace loci::gui {
namespace {

constexpr int kImageSide = 64;

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
  QFont bold = scaled_font(font(), 1.25);
  bold.setBold(true);
  title_->setFont(bold);
  hint_->setWordWrap(true);
  build_rows();
  history_->setModel(model_);
  history_->setSelectionBehavior(QAbstractItemView::SelectRows);
  history_->setShowGrid(false);
  history_->setFrameShape(QFrame::NoFrame);
  history_->setMinimumHeight(2 * (fontMetrics().height() + 6));
  history_->verticalHeader()->hide();
  history_->verticalHeader()->setDefaultSectionSize(fontMetrics().height() + 6);
  history_->setHorizontalScrollMode(QAbstractItemView::ScrollPerPixel);
  history_->horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
  history_->horizontalHeader()->setSectionResizeMode(HistoryModel::place_column, QHeaderView::Stretch);
  history_->horizontalHeader()->setHighlightSections(false);
  history_->horizontalHeader()->setDefaultAlignment(Qt::AlignLeft | Qt::AlignVCenter);
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
  for (const char* name : {"Place", "State", "Last seen", "Colour", "Size", "Position"}) {
    auto* value = selectable_label(rows_);
    form->addRow(name, value);
    if (QString(name) == "State") value->setToolTip(kPresenceHelp);
    values_.emplace_back(name, value);
  }
  probability_->setRange(0, 1000);
  probability_->setTextVisible(true);
  probability_->setFixedHeight(fontMetrics().height() + 4);
  probability_->setToolTip("How probable it is that the object still is at this place");
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
  if (!selection.place().empty()) {
    int there = 0;
    for (const BelievedObject& object : browser_.belief().objects)
      there += object.place == selection.place() && object.presence != Presence::gone;
    return show_nothing(QString::fromStdString(selection.place()),
                        there == 0 ? QString("Nothing is believed to be here.")
                                   : QString("%1 object%2 here.").arg(there).arg(there == 1 ? "" : "s"));
  }
  show_nothing("", browser_.data() == nullptr ? "" : "Click an object in the tree, the map or the image.");
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
  const int zone = browser_.data()->info().zone_minutes;
  const Theme theme = Theme::of(palette());
  title_->setVisible(true);
  title_->setText(QString::fromStdString(object.name));
  QStringList said;
  if (object.name != "object_" + std::to_string(object.id)) said << QString("object_%1").arg(object.id);
  if (!object.class_name.empty()) said << QString::fromStdString(object.class_name);
  if (!object.owner.empty()) said << "of " + QString::fromStdString(object.owner);
  hint_->setText(said.join(", "));
  const QString place = QString::fromStdString(object.place);
  const QString at = object.place.empty() ? "unknown" : place;
  QString seen = "never";
  if (object.last_seen) {
    seen = time_text(*object.last_seen, zone);
    const QString ago = duration_text(*object.last_seen, browser_.selection().time());
    if (object.presence != Presence::seen) seen += QString(" (%1 before)").arg(ago);
  }
  QString position = "unknown";
  if (object.map_from_object) {
    const Vector3d p = object.map_from_object->translation();
    position = QString("%1, %2, %3 m").arg(p.x(), 0, 'f', 2).arg(p.y(), 0, 'f', 2).arg(p.z(), 0, 'f', 2);
  }
  const std::vector<QString> values = {
      object.presence == Presence::gone ? QString("gone, last on %1").arg(at) : at,
      presence_name(object.presence),
      seen,
      object.color_name.empty() ? "unknown" : QString::fromStdString(object.color_name),
      object.size.isZero() ? "unknown" : size_text(object.size),
      position};
  for (size_t i = 0; i < values.size(); ++i) values_[i].second->setText(values[i]);
  probability_->setValue(static_cast<int>(object.probability * 1000));
  probability_->setFormat(percent_text(object.probability));
  QPalette colors = palette();
  colors.setColor(QPalette::Highlight, theme.of_presence(object.presence));
  colors.setColor(QPalette::HighlightedText,
                  colors.color(QPalette::Highlight).lightness() > 140 ? Qt::black : Qt::white);
  probability_->setPalette(colors);
  rows_->show();
  pages_->show();
  show_image();
}

void ObjectCard::show_image() {
  const int64_t object = *browser_.selection().object();
  if (object != imaged_) image_->hide();  // of another object
  browser_.reader().read<cv::Mat>(
      this, "image", Urgency::selection,
      [object, time = browser_.selection().time()](const BrowserData& memory) {
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
