#include "gui/views/compare_view.h"

#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QTableWidget>
#include <QToolButton>
#include <QVBoxLayout>

#include "gui/text.h"
#include "gui/theme.h"

namespace loci {
namespace {

enum Column { what_column, name_column, then_column, now_column, column_count };

QColor color_of(const Theme& theme, Difference::Kind kind) {
  switch (kind) {
    case Difference::Kind::appeared:
      return theme.of_event("appeared");
    case Difference::Kind::moved:
      return theme.of_event("moved");
    case Difference::Kind::gone:
      return theme.of_event("gone");
    case Difference::Kind::joint:
      return theme.of_event("joint_changed");
  }
  return theme.text;
}

}  // namespace

CompareView::CompareView(Browser& browser, QWidget* parent)
    : QWidget(parent),
      browser_(browser),
      stamp_(new QLineEdit(this)),
      state_(new QLabel(this)),
      table_(new QTableWidget(0, column_count, this)) {
  stamp_->setToolTip("The time to compare the chosen one with: 2026-05-01 08:30, 08:30, yesterday 9:00");
  auto* pin = new QToolButton(this);
  pin->setText("Chosen time");
  pin->setToolTip("Compare with the chosen time, then choose another");
  table_->setSelectionBehavior(QAbstractItemView::SelectRows);
  table_->setSelectionMode(QAbstractItemView::SingleSelection);
  table_->setEditTriggers(QAbstractItemView::NoEditTriggers);
  table_->setShowGrid(false);
  table_->verticalHeader()->hide();
  table_->verticalHeader()->setDefaultSectionSize(fontMetrics().height() + 6);
  table_->horizontalHeader()->setDefaultAlignment(Qt::AlignLeft | Qt::AlignVCenter);
  table_->horizontalHeader()->setHighlightSections(false);
  table_->horizontalHeader()->setSectionResizeMode(QHeaderView::Stretch);
  table_->horizontalHeader()->setSectionResizeMode(what_column, QHeaderView::ResizeToContents);
  state_->setWordWrap(true);
  auto* head = new QHBoxLayout;
  head->addWidget(new QLabel("Compare with", this));
  head->addWidget(stamp_, 1);
  head->addWidget(pin);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(8, 6, 8, 6);
  layout->addLayout(head);
  layout->addWidget(state_);
  layout->addWidget(table_, 1);
  connect(pin, &QToolButton::clicked, this, [this] { set_other(browser_.selection().time()); });
  connect(stamp_, &QLineEdit::returnPressed, this, &CompareView::take_stamp);
  connect(table_, &QTableWidget::cellClicked, this, [this](int row, int) {
    if (const int64_t object = differences_[static_cast<size_t>(row)].object; object != 0)
      browser_.selection().select_object(object);
  });
  connect(&browser_, &Browser::opened, this, &CompareView::forget);
  connect(&browser_, &Browser::belief_changed, this, &CompareView::refresh);
  forget();
}

void CompareView::forget() {
  const BrowserData* memory = browser_.data();
  const std::string path = memory == nullptr ? "" : memory->info().path;
  if (path == memory_) return;  // it has grown: the time stays
  memory_ = path;
  set_other(memory == nullptr || memory->scenes().empty() ? 0 : memory->scenes().front().time);
}

void CompareView::set_other(TimeNs time) {
  other_ = time;
  refresh();
}

void CompareView::take_stamp() {
  const std::string typed = stamp_->text().toStdString();
  refresh();  // what cannot be read is not taken
  browser_.reader().read<TimeNs>(
      this, "stamp", Urgency::moment,
      [text = typed](const BrowserData& memory) { return memory.time_of(text); },
      [this](const TimeNs& time) { set_other(time); });
}

void CompareView::showEvent(QShowEvent* event) {
  QWidget::showEvent(event);
  refresh();
}

void CompareView::refresh() {
  if (!isVisible()) return;
  differences_.clear();
  const BrowserData* memory = browser_.data();
  setEnabled(memory != nullptr);
  if (memory == nullptr) {
    state_->setText("Open a memory to compare two of its times.");
    stamp_->clear();
    return fill();
  }
  stamp_->setText(time_text(other_, memory->info().zone_minutes));
  stamp_->setCursorPosition(0);
  browser_.reader().read<BelievedScene>(
      this, "other", Urgency::moment,
      [time = other_](const BrowserData& source) { return source.belief_at(time); },
      [this](const BelievedScene& then) { show_differences(then); });
}

void CompareView::show_differences(const BelievedScene& then) {
  differences_ = differences(then, browser_.belief());
  if (other_ == browser_.selection().time())
    state_->setText("This is the chosen time: choose another one below.");
  else if (differences_.empty())
    state_->setText("Nothing differs.");
  else
    state_->setText(
        QString("%1 difference%2").arg(differences_.size()).arg(differences_.size() == 1 ? "" : "s"));
  fill();
}

void CompareView::fill() {
  const Theme theme = Theme::of(palette());
  const BrowserData* memory = browser_.data();
  const int zone = memory == nullptr ? 0 : memory->info().zone_minutes;
  const auto head = [&](TimeNs time) { return "At " + time_text(time, zone).mid(11, 8); };
  const bool known = memory != nullptr;
  table_->setHorizontalHeaderLabels(
      {"", "What", known ? head(other_) : "Then", known ? head(browser_.selection().time()) : "Now"});
  table_->setRowCount(static_cast<int>(differences_.size()));
  for (int row = 0; row < table_->rowCount(); ++row) {
    const Difference& difference = differences_[static_cast<size_t>(row)];
    const auto put = [&](int column, const QString& text) {
      auto* item = new QTableWidgetItem(text);
      item->setToolTip(text);
      table_->setItem(row, column, item);
      return item;
    };
    QString what = difference_name(difference.kind);
    if (difference.kind == Difference::Kind::moved && difference.then == difference.now)
      what += QString(" %1 cm").arg(difference.distance * 100, 0, 'f', 0);
    put(what_column, what)->setForeground(color_of(theme, difference.kind));
    put(name_column, QString::fromStdString(difference.name));
    put(then_column, difference.then.empty() ? QString("–") : QString::fromStdString(difference.then));
    put(now_column, difference.now.empty() ? QString("–") : QString::fromStdString(difference.now));
  }
}

}  // namespace loci
