#include "gui/views/compare_view.h"

#include <QCheckBox>
#include <QComboBox>
#include <QFileDialog>
#include <QFileInfo>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QTableView>
#include <QToolButton>
#include <QVBoxLayout>

#include "gui/core/background.h"
#include "gui/core/text.h"
#include "gui/data/open_memory.h"
#include "gui/models/table_models.h"

namespace loci::gui {
namespace {

constexpr int kRowsMeasured = 20;  // for the width of a column

}  // namespace

CompareView::CompareView(Browser& browser, QWidget* parent)
    : Page(parent),
      browser_(browser),
      stamp_(new QLineEdit(this)),
      source_(new QComboBox(this)),
      beside_(new QCheckBox("Both maps", this)),
      state_(new QLabel(this)),
      model_(new DifferencesModel(this)),
      table_(new QTableView(this)) {
  table_->setModel(model_);
  stamp_->setToolTip("The time to compare the selected one with: 2026-05-01 08:30, 08:30, yesterday 9:00");
  auto* pin = new QToolButton(this);
  pin->setText("Selected time");
  pin->setToolTip("Compare with the selected time, then select another");
  style_table(*table_);
  table_->setSelectionMode(QAbstractItemView::SingleSelection);
  table_->horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
  table_->horizontalHeader()->setResizeContentsPrecision(kRowsMeasured);
  // Both times stay in view: names that are too long are cut off, and tooltips show them.
  for (const int column :
       {DifferencesModel::name_column, DifferencesModel::then_column, DifferencesModel::now_column})
    table_->horizontalHeader()->setSectionResizeMode(column, QHeaderView::Stretch);
  table_->setHorizontalScrollMode(QAbstractItemView::ScrollPerPixel);
  state_->setWordWrap(true);
  auto* head = new QHBoxLayout;
  head->addWidget(new QLabel("Compare with", this));
  head->addWidget(stamp_, 1);
  head->addWidget(pin);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(8, 6, 8, 6);
  source_->setToolTip(
      "What the other time is taken from: this memory, what it knew before something was added, corrected or "
      "reasoned again, or another memory (loci-memory changes, was --known-at)");
  source_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  source_->setMinimumContentsLength(14);
  connect(source_, QOverload<int>::of(&QComboBox::activated), this, &CompareView::take_source);
  layout->addLayout(head);
  beside_->setToolTip(
      "The map of the other time or memory beside the map, seen by the same eye; what differs has coloured "
      "edges (loci-browse --beside)");
  auto* second = new QHBoxLayout;
  second->addWidget(source_, 1);
  second->addWidget(beside_);
  layout->addLayout(second);
  connect(beside_, &QCheckBox::toggled, this, [this](bool on) {
    if (on)
      refresh();
    else
      Q_EMIT compared();
  });
  layout->addWidget(state_);
  layout->addWidget(table_, 1);
  connect(pin, &QToolButton::clicked, this, [this] { set_other(browser_.selection().time()); });
  connect(stamp_, &QLineEdit::returnPressed, this, &CompareView::take_stamp);
  connect(table_, &QTableView::clicked, this, [this](const QModelIndex& index) {
    if (const int64_t object = shown()[static_cast<size_t>(index.row())].object; object > 0)
      browser_.selection().select_object(object);
  });
  connect(&browser_, &Browser::opened, this, &CompareView::forget);
  connect(&browser_, &Browser::belief_changed, this, &CompareView::refresh);
  forget();
}

void CompareView::forget() {
  const OpenMemory* memory = browser_.data();
  const std::string path = memory == nullptr ? "" : memory->info().path;
  fill_sources();
  if (path == memory_) return;  // it has grown: the time stays
  memory_ = path;
  known_at_.reset();
  another_.reset();
  fill_sources();
  set_other(memory == nullptr || memory->scenes().empty() ? 0 : memory->scenes().front().time);
}

void CompareView::fill_sources() {
  source_->clear();
  source_->addItem("This memory, as known now");
  if (browser_.data() != nullptr)
    for (const KnownState& state : browser_.data()->info().known) {
      source_->addItem("This memory, as known " + QString::fromStdString(state.before),
                       static_cast<qlonglong>(state.known_at));
      if (known_at_ == state.known_at) source_->setCurrentIndex(source_->count() - 1);
    }
  if (another_ != nullptr) {
    source_->addItem(QFileInfo(QString::fromStdString(another_->info().path)).fileName());
    source_->setCurrentIndex(source_->count() - 1);
  }
  source_->addItem("Another memory…");
}

void CompareView::take_source(int index) {
  if (index == source_->count() - 1) return ask_for_memory();
  if (another_ != nullptr && index == source_->count() - 2) return;
  another_.reset();
  const QVariant known_at = source_->itemData(index);
  known_at_ = known_at.isValid() ? std::optional<TimeNs>(known_at.toLongLong()) : std::nullopt;
  // Two reasonings are compared at one time.
  if (known_at_) other_ = browser_.selection().time();
  fill_sources();
  refresh();
}

void CompareView::ask_for_memory() {
  const QString path =
      QFileDialog::getOpenFileName(this, "Compare with a memory", {}, "Memories (*.loci);;All files (*)");
  fill_sources();
  if (!path.isEmpty()) compare_with(path);
}

void CompareView::compare_with(const QString& path) {
  in_background<std::shared_ptr<const OpenMemory>>(
      this,
      [path = path.toStdString()]() -> std::shared_ptr<const OpenMemory> { return OpenMemory::open(path); },
      [this](const std::shared_ptr<const OpenMemory>& memory) {
        another_ = memory;
        known_at_.reset();
        fill_sources();
        set_other(memory->scenes().empty() ? 0 : memory->scenes().back().time);
      },
      [this](const std::exception_ptr& error) { Q_EMIT browser_.failed(reason_of(error)); });
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
      [text = typed, another = another_](const OpenMemory& memory) {
        return (another ? *another : memory).time_of(text);
      },
      [this](const TimeNs& time) { set_other(time); });
}

void CompareView::refresh() {
  if (!is_in_front() && !beside_->isChecked()) return;
  const OpenMemory* memory = browser_.data();
  setEnabled(memory != nullptr);
  if (memory == nullptr) {
    state_->setText("Open a memory to compare two of its times.");
    stamp_->clear();
    model_->set({}, "Then", "Now");
    Q_EMIT compared();
    return;
  }
  stamp_->setText(time_text(other_, memory->info().zone));
  stamp_->setCursorPosition(0);
  read_other();
}

void CompareView::read_other() {
  browser_.reader().read<Belief>(
      this, "other", Urgency::moment,
      [time = other_, known_at = known_at_, another = another_](const OpenMemory& source) {
        return another ? another->belief_at(time) : source.belief_at(time, known_at);
      },
      [this](const Belief& then) {
        same_.clear();
        if (!another_) return show_differences(then);
        const Belief same = renumbered(then, browser_.belief());
        for (size_t i = 0; i < same.objects.size(); ++i)
          same_.emplace_back(same.objects[i].object, then.objects[i].object);
        show_differences(same);
      });
}

void CompareView::show_differences(const Belief& then) {
  const TimeZone& zone = browser_.data()->info().zone;
  const TimeNs here = browser_.selection().time();
  const bool same_day = time_text(other_, zone).left(10) == time_text(here, zone).left(10);
  const auto head = [&](const QString& which, TimeNs time, const OpenMemory& memory) {
    const QString text = time_text(time, zone);  // on lines of their own: the columns are narrow
    if (another_)                                // the times may be the same
      return which + "\n" + QFileInfo(QString::fromStdString(memory.info().path)).fileName() + "\n" +
             text.mid(5);
    return which + "\n" + (same_day ? text.mid(11, 8) : text.mid(5, 14));
  };
  const PlaceNames names = another_ ? PlaceNames::of_two_memories : PlaceNames::of_one_memory;
  model_->set(
      differences(then, browser_.belief(), names),
      head(known_at_ ? "As known then" : "Other time", other_, another_ ? *another_ : *browser_.data()),
      head("Selected", here, *browser_.data()));
  if (other_ == browser_.selection().time() && !known_at_ && !another_)
    state_->setText("This is the selected time: select another one below.");
  else if (shown().empty())
    state_->setText("Nothing differs.");
  else
    state_->setText(QString("%1 difference%2").arg(shown().size()).arg(shown().size() == 1 ? "" : "s"));
  Q_EMIT compared();
}

OtherBelief CompareView::beside() const {
  OtherBelief other;
  if (!beside_->isChecked() || browser_.data() == nullptr) return other;
  other.memory = another_ ? another_ : browser_.shared_data();
  other.time = other_;
  other.known_at = known_at_;
  other.same = same_;
  other.is_same_memory = another_ == nullptr;
  other.title = time_text(other_, other.memory->info().zone);
  if (another_ || known_at_) other.title += ", " + source_->currentText();
  return other;
}

}  // namespace loci::gui
