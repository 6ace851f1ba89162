#include "gui/views/compare_view.h"

#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QTableView>
#include <QToolButton>
#include <QVBoxLayout>

#include "gui/models/differences_model.h"
#include "gui/text.h"

namespace loci {
namespace {

constexpr int kRowsMeasured = 20;  // for the width of a column

}  // namespace

CompareView::CompareView(Browser& browser, QWidget* parent)
    : Page(parent),
      browser_(browser),
      stamp_(new QLineEdit(this)),
      state_(new QLabel(this)),
      model_(new DifferencesModel(this)),
      table_(new QTableView(this)) {
  table_->setModel(model_);
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
  table_->horizontalHeader()->setResizeContentsPrecision(kRowsMeasured);
  table_->horizontalHeader()->setSectionResizeMode(DifferencesModel::what_column,
                                                   QHeaderView::ResizeToContents);
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
  connect(table_, &QTableView::clicked, this, [this](const QModelIndex& index) {
    if (const int64_t object = shown()[static_cast<size_t>(index.row())].object; object != 0)
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

void CompareView::refresh() {
  if (!is_looked_at()) return;
  const BrowserData* memory = browser_.data();
  setEnabled(memory != nullptr);
  if (memory == nullptr) {
    state_->setText("Open a memory to compare two of its times.");
    stamp_->clear();
    return model_->set({}, "Then", "Now");
  }
  stamp_->setText(time_text(other_, memory->info().zone_minutes));
  stamp_->setCursorPosition(0);
  browser_.reader().read<BelievedScene>(
      this, "other", Urgency::moment,
      [time = other_](const BrowserData& source) { return source.belief_at(time); },
      [this](const BelievedScene& then) { show_differences(then); });
}

void CompareView::show_differences(const BelievedScene& then) {
  const int zone = browser_.data()->info().zone_minutes;
  const auto head = [zone](TimeNs time) { return "At " + time_text(time, zone).mid(11, 8); };
  model_->set(differences(then, browser_.belief()), head(other_), head(browser_.selection().time()));
  if (other_ == browser_.selection().time())
    state_->setText("This is the chosen time: choose another one below.");
  else if (shown().empty())
    state_->setText("Nothing differs.");
  else
    state_->setText(QString("%1 difference%2").arg(shown().size()).arg(shown().size() == 1 ? "" : "s"));
}

}  // namespace loci
