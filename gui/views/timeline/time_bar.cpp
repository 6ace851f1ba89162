#include "gui/views/timeline/time_bar.h"

#include <QComboBox>
#include <QEvent>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPainter>
#include <QPixmap>
#include <QPolygonF>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>

#include "gui/core/text.h"
#include "gui/core/theme.h"
#include "gui/views/timeline/lane_view.h"
#include "gui/views/timeline/time_track.h"
#include "memory/questions/events.h"

namespace loci::gui {
namespace {

constexpr int kSide = 32;  // drawn large, shown small: sharp on any screen

void triangle(QPainter& painter, double from, double to) {
  painter.drawPolygon(QPolygonF({QPointF(from, 7), QPointF(to, 16), QPointF(from, 25)}));
}

void bar(QPainter& painter, double left, double width) {
  painter.drawRect(QRectF(left, 7, width, 18));
}

/// The signs of a player in the colour of the text: those of Qt are black in dark palettes too.
QIcon transport_icon(Transport sign, const QColor& color) {
  QPixmap pixmap(kSide, kSide);
  pixmap.fill(Qt::transparent);
  QPainter painter(&pixmap);
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setPen(Qt::NoPen);
  painter.setBrush(color);
  switch (sign) {
    case Transport::first:
      bar(painter, 7, 3);
      triangle(painter, 25, 11);
      break;
    case Transport::previous:
      triangle(painter, 16, 5);
      triangle(painter, 27, 16);
      break;
    case Transport::play:
      triangle(painter, 9, 26);
      break;
    case Transport::pause:
      bar(painter, 8, 6);
      bar(painter, 18, 6);
      break;
    case Transport::next:
      triangle(painter, 5, 16);
      triangle(painter, 16, 27);
      break;
    case Transport::last:
      triangle(painter, 7, 21);
      bar(painter, 22, 3);
      break;
  }
  return QIcon(pixmap);
}

constexpr int kPlayStepMs = 700;
}  // namespace

TimeBar::TimeBar(Browser& browser, QWidget* parent)
    : QWidget(parent),
      browser_(browser),
      track_(new TimeTrack(browser, axis_, this)),
      lanes_(new LaneView(browser, axis_, this)),
      stamp_(new QLineEdit(this)),
      zone_(new QLabel(this)),
      scene_(new QLabel(this)),
      happened_(new QLabel(this)),
      legend_(new QLabel(this)),
      known_(new QComboBox(this)) {
  auto* line = new QHBoxLayout;
  line->setSpacing(4);
  add_buttons(*line);
  line->addSpacing(6);
  add_stamp(*line);
  line->addSpacing(6);
  add_known(*line);
  line->addSpacing(12);
  line->addWidget(scene_);
  line->addSpacing(12);
  happened_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  happened_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
  line->addWidget(happened_, 1);
  line->addWidget(legend_);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(8, 6, 8, 2);
  layout->setSpacing(2);
  layout->addLayout(line);
  layout->addWidget(track_);
  layout->addWidget(lanes_, 1);
  paint_buttons();
  timer_.setInterval(kPlayStepMs);
  connect(&timer_, &QTimer::timeout, this, &TimeBar::play_step);
  connect(&browser_, &Browser::opened, this, &TimeBar::take_memory);
  connect(&browser_, &Browser::time_changed, this, &TimeBar::refresh);
  refresh();
}

void TimeBar::add_buttons(QHBoxLayout& line) {
  const auto add = [&](Transport sign, const QString& tip, auto action) {
    auto* button = new QToolButton(this);
    buttons_.emplace_back(sign, button);
    button->setAutoRaise(true);
    button->setToolTip(tip);
    button->setFocusPolicy(Qt::NoFocus);
    connect(button, &QToolButton::clicked, this, action);
    line.addWidget(button);
  };
  add(Transport::first, "First scene (Home)", [this] { browser_.to_first(); });
  add(Transport::previous, "Previous scene (Left)", [this] { browser_.step(-1); });
  add(Transport::play, "Play (Space)", [this] { toggle_play(); });
  add(Transport::next, "Next scene (Right)", [this] { browser_.step(1); });
  add(Transport::last, "Last scene (End)", [this] { browser_.to_last(); });
}

void TimeBar::add_stamp(QHBoxLayout& line) {
  stamp_->setToolTip("The selected time; type another: 2026-05-01 08:30, 08:30, yesterday 9:00 (Ctrl+T)");
  stamp_->setFixedWidth(fontMetrics().horizontalAdvance("2026-05-01 00:00:00.000000") + 24);
  line.addWidget(stamp_);
  line.addWidget(zone_);
  connect(stamp_, &QLineEdit::returnPressed, this, &TimeBar::take_stamp);
  connect(stamp_, &QLineEdit::editingFinished, this, &TimeBar::refresh);
}

void TimeBar::add_known(QHBoxLayout& line) {
  known_->setToolTip(
      "Transaction time: what the memory knew of the selected time, now or before something was added or "
      "corrected");
  known_->setFocusPolicy(Qt::NoFocus);
  known_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  known_->setMinimumContentsLength(14);
  known_->setMinimumWidth(fontMetrics().horizontalAdvance("As known") + 24);  // narrow windows cut it off
  line.addWidget(known_);
  connect(known_, QOverload<int>::of(&QComboBox::activated), this, [this](int index) {
    const QVariant at = known_->itemData(index);
    browser_.selection().set_known_at(at.isValid() ? std::optional<TimeNs>(at.toLongLong()) : std::nullopt);
  });
}

void TimeBar::take_memory() {
  const OpenMemory* memory = browser_.data();
  if (memory != nullptr && !memory->scenes().empty()) {
    const TimeNs first = memory->scenes().front().time, last = memory->scenes().back().time;
    if (memory->info().path == memory_)
      axis_.grow(first, last);
    else
      axis_.set_whole(first, last);
  }
  memory_ = memory == nullptr ? "" : memory->info().path;
  fill_known();
  refresh();
}

QString TimeBar::legend() const {
  const Theme theme = Theme::of(palette());
  QStringList scenes, events;
  const auto part = [](const char* sign, const QColor& color, const char* text) {
    return QString("<span style='color:%1'>%2</span> %3").arg(color.name(), sign, text);
  };
  for (const auto& [color, text] : {std::pair(theme.seen, "seen"), std::pair(theme.gone, "missed"),
                                    std::pair(theme.grid, "not observed")})
    scenes << part("■", color, text);
  for (const auto& [kind, text] :
       {std::pair(memory::EventKind::appeared, "appeared"), std::pair(memory::EventKind::moved, "moved"),
        std::pair(memory::EventKind::hidden, "hidden"), std::pair(memory::EventKind::gone, "gone"),
        std::pair(memory::EventKind::joint_changed, "other")})
    events << part("●", theme.of_event(kind), text);
  return scenes.join("&nbsp;&nbsp; ") + "<br>" + events.join("&nbsp;&nbsp; ");
}

void TimeBar::paint_buttons() {
  legend_->setText(legend());
  legend_->setFont(small_font(font()));
  legend_->setToolTip(
      "Squares: what each scene showed of an object: it was seen; its place was seen without it; or nothing, "
      "because it was out of view or behind something.\n"
      "Dots: events; appeared or seen again, moved, hidden, gone, and other ones: a joint was moved, an "
      "object "
      "looks different. Of a selected object they are in colour, those of others grey.");
  for (const auto& [sign, button] : buttons_) {
    const bool pause = sign == Transport::play && timer_.isActive();
    button->setIcon(transport_icon(pause ? Transport::pause : sign, Theme::of(palette()).text));
  }
}

/// A line that is cut off ends in "…".
void TimeBar::elide() {
  const int width = std::max(0, happened_->width() - 2);
  happened_->setText(fontMetrics().elidedText(happened_->toolTip(), Qt::ElideRight, width));
}

void TimeBar::resizeEvent(QResizeEvent* event) {
  QWidget::resizeEvent(event);
  layout()->activate();
  elide();
}

void TimeBar::changeEvent(QEvent* event) {
  QWidget::changeEvent(event);
  if (event->type() == QEvent::PaletteChange) paint_buttons();
}

void TimeBar::take_focus() {
  track_->setFocus();
}

void TimeBar::toggle_play() {
  if (timer_.isActive()) {
    timer_.stop();
  } else if (browser_.data() != nullptr && !browser_.data()->scenes().empty()) {
    if (browser_.selection().time() >= browser_.data()->scenes().back().time) browser_.to_first();
    timer_.start();
  }
  paint_buttons();
}

void TimeBar::play_step() {
  const TimeNs before = browser_.selection().time();
  browser_.step(1);
  if (browser_.selection().time() == before) toggle_play();
}

void TimeBar::take_stamp() {
  browser_.reader().read<TimeNs>(
      this, "stamp", Urgency::moment,
      [text = stamp_->text().toStdString()](const OpenMemory& memory) { return memory.time_of(text); },
      [this](const TimeNs& time) { browser_.selection().set_time(time); });
  track_->setFocus();
  refresh();  // what cannot be read is not taken
}

void TimeBar::fill_known() {
  known_->clear();
  known_->addItem("As known now");
  if (browser_.data() == nullptr) return;
  const auto& states = browser_.data()->info().known;
  for (auto state = states.rbegin(); state != states.rend(); ++state) {
    known_->addItem(QString::fromStdString(state->before), static_cast<qlonglong>(state->known_at));
    if (browser_.selection().known_at() == state->known_at) known_->setCurrentIndex(known_->count() - 1);
  }
}

namespace {

/// "scene 3 of 24, 2 h before".
QString scene_in_words(const OpenMemory& memory, const memory::SceneRow& scene, TimeNs time) {
  const size_t count = memory.scenes().size();
  const QString apart = apart_text(scene.time, time);
  if (scene.time > time) return QString("no scene yet; the first of %1 is %2").arg(count).arg(apart);
  const auto number = &scene - memory.scenes().data() + 1;
  return QString("scene %1 of %2").arg(number).arg(count) + (apart.isEmpty() ? "" : ", " + apart);
}

}  // namespace

QString TimeBar::scene_text() const {
  return scene_->text();
}

QString TimeBar::what_happened() const {
  const memory::SceneRow* scene = browser_.scene();
  if (scene != nullptr && scene->time > browser_.selection().time()) return {};
  QStringList texts;
  const auto& events = browser_.data()->events();
  const auto first =
      std::lower_bound(events.begin(), events.end(), scene == nullptr ? 0 : scene->time,
                       [](const memory::Change& event, TimeNs time) { return event.time < time; });
  for (auto event = first; scene != nullptr && event != events.end() && event->time == scene->time; ++event)
    texts << QString::fromStdString(to_text(*event));
  if (texts.isEmpty()) return "nothing changed";
  return texts.size() <= 3 ? texts.join(" · ")
                           : QString("%1 · and %2 more")
                                 .arg(QStringList(texts.mid(0, 3)).join(" · "))
                                 .arg(texts.size() - 3);
}

void TimeBar::refresh() {
  const OpenMemory* memory = browser_.data();
  setEnabled(memory != nullptr && !memory->scenes().empty());
  if (memory == nullptr || memory->scenes().empty()) {
    stamp_->clear();
    for (QLabel* label : {zone_, scene_, happened_}) label->clear();
    return;
  }
  axis_.reveal(browser_.selection().time());
  const MemoryInfo& info = memory->info();
  stamp_->setText(time_text(browser_.selection().time(), info.zone));
  stamp_->setCursorPosition(0);
  zone_->setText(zone_text(browser_.selection().time(), info.zone) + (info.time_assumed ? ", assumed" : ""));
  zone_->setToolTip(info.time_assumed ? "The recording had no time stamps: these were made up at 30 Hz"
                                      : "Time zone of all times shown");
  const memory::SceneRow* scene = browser_.scene();
  scene_->setText(scene_in_words(*memory, *scene, browser_.selection().time()));
  happened_->setToolTip(what_happened());
  elide();
  QPalette colors = palette();
  colors.setColor(QPalette::WindowText, Theme::of(palette()).muted);
  for (QLabel* label : {zone_, happened_, legend_}) label->setPalette(colors);
}

}  // namespace loci::gui
