#include "gui/views/timeline/time_track.h"

#include <QHelpEvent>
#include <QMouseEvent>
#include <QPainter>
#include <QToolTip>
#include <QWheelEvent>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "gui/core/text.h"
#include "gui/core/theme.h"
#include "memory/questions/events.h"

namespace loci::gui {
namespace {
constexpr TimeNs kMinSpan = kSecond / 10;
}

void TimeAxis::set_whole(TimeNs first, TimeNs last) {
  first_ = first;
  last_ = last;
  from_ = to_ = 0;
  show(first, last);
}

void TimeAxis::grow(TimeNs first, TimeNs last) {
  if (from_ == first_ && to_ == last_) return set_whole(first, last);
  first_ = first;
  last_ = last;
}

void TimeAxis::show(TimeNs from, TimeNs to) {
  from = std::max(from, first_);
  to = std::min(to, last_);
  if (from == from_ && to == to_) return;
  from_ = from;
  to_ = to;
  Q_EMIT changed();
}

double TimeAxis::x_of(TimeNs time, int width) const {
  const double span = std::max(1.0, static_cast<double>(to_ - from_));
  return kLeft + (width - kLeft - kRight) * static_cast<double>(time - from_) / span;
}

TimeNs TimeAxis::time_at(double x, int width) const {
  const double part = std::clamp((x - kLeft) / std::max(1.0, width - kLeft - kRight), 0.0, 1.0);
  return from_ + std::llround(part * static_cast<double>(to_ - from_));
}

void TimeAxis::zoom(double factor, TimeNs at) {
  const auto scaled = [&](TimeNs span) { return std::llround(static_cast<double>(span) * factor); };
  const TimeNs from = at - scaled(at - from_);
  const TimeNs to = at + scaled(to_ - at);
  if (to - from >= std::min(kMinSpan, last_ - first_)) show(from, to);
}

void TimeAxis::pan(double part) {
  const TimeNs span = to_ - from_;
  const TimeNs by =
      std::clamp<TimeNs>(std::llround(part * static_cast<double>(span)), first_ - from_, last_ - to_);
  show(from_ + by, to_ + by);
}

void TimeAxis::reveal(TimeNs time) {
  if (time < first_ || time > last_) {  // before or after all scenes
    set_whole(std::min(first_, time), std::max(last_, time));
    return;
  }
  const TimeNs span = to_ - from_;
  if (time >= from_ && time <= to_) return;
  const TimeNs from = std::clamp(time - span / 2, first_, std::max(first_, last_ - span));
  show(from, from + span);
}

namespace {

constexpr double kEventsY = 12;  // middle of the row of events
constexpr double kAxisY = 30;    // the line that the handle moves on
constexpr double kTextY = 44;    // top of the hours
constexpr double kDotRadius = 4;

/// Round steps for labels, from milliseconds to months.
TimeNs label_step(TimeNs span, double pixels) {
  constexpr TimeNs kMs = kSecond / 1000;
  constexpr std::array<TimeNs, 24> kSteps = {
      50 * kMs,         100 * kMs,        200 * kMs,         500 * kMs,         kSecond,
      2 * kSecond,      5 * kSecond,      10 * kSecond,      30 * kSecond,      60 * kSecond,
      120 * kSecond,    300 * kSecond,    600 * kSecond,     1800 * kSecond,    3600 * kSecond,
      7200 * kSecond,   14400 * kSecond,  21600 * kSecond,   43200 * kSecond,   86400 * kSecond,
      172800 * kSecond, 604800 * kSecond, 2592000 * kSecond, 31536000 * kSecond};
  const double least = static_cast<double>(span) * 90 / std::max(pixels, 1.0);
  for (const TimeNs step : kSteps)
    if (static_cast<double>(step) >= least) return step;
  return kSteps.back();
}

bool is_of(const memory::Change& event, memory::Id object) {
  return event.object && event.object->id == object;
}

/// With the date where `dated`: a day begins, or the axis.
QString tick_text(TimeNs time, TimeNs step, const TimeZone& zone, bool dated) {
  const QString text = time_text(time, zone);  // "2026-05-01 09:10:00.5"
  if (step >= 86400 * kSecond) return text.left(10);
  if (dated) return text.mid(11, 5) == "00:00" ? text.mid(5, 5) : text.mid(5, 11);
  if (step >= 60 * kSecond) return text.mid(11, 5);
  return step >= kSecond ? text.mid(11, 8) : text.mid(11, 10);
}

}  // namespace

TimeNs snapped_time(const OpenMemory& memory, const TimeAxis& axis, double x, int width) {
  const auto& scenes = memory.scenes();
  const TimeNs time = axis.time_at(x, width);
  const auto after = std::lower_bound(scenes.begin(), scenes.end(), time,
                                      [](const memory::SceneRow& scene, TimeNs t) { return scene.time < t; });
  TimeNs result = time;
  double nearest = TimeAxis::kSnap;
  for (auto scene = after == scenes.begin() ? after : after - 1; scene != scenes.end() && scene <= after;
       ++scene)
    if (const double distance = std::abs(axis.x_of(scene->time, width) - x); distance < nearest) {
      nearest = distance;
      result = scene->time;
    }
  return result;
}

TimeTrack::TimeTrack(Browser& browser, TimeAxis& axis, QWidget* parent)
    : QWidget(parent), browser_(browser), axis_(axis) {
  setFocusPolicy(Qt::StrongFocus);
  setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
  setMouseTracking(true);
  connect(&browser_, &Browser::opened, this, &TimeTrack::refresh);
  connect(&browser_, &Browser::selected, this, &TimeTrack::refresh);
  connect(&browser_, &Browser::time_changed, this, [this] { update(); });
  connect(&axis_, &TimeAxis::changed, this, &TimeTrack::redraw);
  refresh();
}

void TimeTrack::refresh() {
  observations_.clear();
  if (const auto object = browser_.selection().object())
    browser_.reader().read<std::vector<TimeNs>>(
        this, "observations", Urgency::selection,
        [id = *object](const OpenMemory& memory) { return memory.observations(id); },
        [this](std::vector<TimeNs>& times) {
          observations_ = std::move(times);
          redraw();
        });
  else
    browser_.reader().forget(this, "observations");
  redraw();
}

void TimeTrack::redraw() {
  backdrop_.forget();
  update();
}

double TimeTrack::x_of(TimeNs time) const {
  return axis_.x_of(time, width());
}

TimeNs TimeTrack::time_at(double x) const {
  return axis_.time_at(x, width());
}

/// Whether a mark at this place is on the axis.
bool TimeTrack::shows(double x) const {
  return x > TimeAxis::kLeft - 1 && x < width() - TimeAxis::kRight + 1;
}

void TimeTrack::drag(double x) {
  const OpenMemory* memory = browser_.data();
  if (memory != nullptr && !memory->scenes().empty())
    browser_.selection().set_time(snapped_time(*memory, axis_, x, width()));
}

void TimeTrack::mousePressEvent(QMouseEvent* event) {
  dragged_from_ = event->localPos().x();
  if (event->button() == Qt::LeftButton) drag(event->localPos().x());
}

void TimeTrack::mouseMoveEvent(QMouseEvent* event) {
  const double x = event->localPos().x();
  if ((event->buttons() & Qt::LeftButton) != 0) drag(x);
  if ((event->buttons() & Qt::RightButton) == 0) return;
  axis_.pan((dragged_from_ - x) / std::max(1.0, width() - TimeAxis::kLeft - TimeAxis::kRight));
  dragged_from_ = x;
}

void TimeTrack::wheelEvent(QWheelEvent* event) {
  axis_.zoom(event->angleDelta().y() > 0 ? 1 / TimeAxis::kZoomStep : TimeAxis::kZoomStep,
             time_at(event->position().x()));
  event->accept();
}

bool TimeTrack::event(QEvent* event) {
  if (event->type() != QEvent::ToolTip || browser_.data() == nullptr) return QWidget::event(event);
  const auto* help = static_cast<QHelpEvent*>(event);
  QString text;
  for (const memory::Change& entry : browser_.data()->events()) {
    if (std::abs(x_of(entry.time) - help->pos().x()) > kDotRadius + 1) continue;
    if (!text.isEmpty()) text += "\n";
    text += time_text(entry.time, browser_.data()->info().zone).mid(11) + "  " +
            QString::fromStdString(to_text(entry));
    if (text.count('\n') > 12) break;
  }
  if (text.isEmpty()) text = time_text(time_at(help->pos().x()), browser_.data()->info().zone);
  QToolTip::showText(help->globalPos(), text, this);
  return true;
}

void TimeTrack::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.setRenderHint(QPainter::Antialiasing);
  backdrop_.paint(*this, painter, [this](QPainter& inside) { paint_backdrop(inside); });
  if (browser_.data() != nullptr && !browser_.data()->scenes().empty()) paint_handle(painter);
}

void TimeTrack::paint_backdrop(QPainter& painter) const {
  const Theme theme = Theme::of(palette());
  painter.setPen(QPen(theme.grid, 2));
  painter.drawLine(QPointF(TimeAxis::kLeft, kAxisY), QPointF(width() - TimeAxis::kRight, kAxisY));
  painter.setPen(theme.muted);
  for (const auto& [text, middle] : {std::pair("Events", kEventsY), std::pair("Scenes", kAxisY)})
    painter.drawText(QRectF(8, middle - 9, TimeAxis::kLeft - 18, 18), Qt::AlignVCenter | Qt::AlignLeft, text);
  if (browser_.data() == nullptr || browser_.data()->scenes().empty()) return;
  paint_axis(painter);
  paint_events(painter);
}

void TimeTrack::paint_axis(QPainter& painter) const {
  const Theme theme = Theme::of(palette());
  const TimeZone& zone = browser_.data()->info().zone;
  double last = -1;  // one mark per pixel, however many scenes are in it
  const auto mark = [&](TimeNs time) {
    const double x = std::round(x_of(time)) + 0.5;
    if (!shows(x) || x == last) return;
    last = x;
    painter.drawLine(QPointF(x, kAxisY - 5), QPointF(x, kAxisY + 5));
  };
  painter.setPen(QPen(theme.muted, 1));
  for (const memory::SceneRow& scene : browser_.data()->scenes()) mark(scene.time);
  last = -1;
  painter.setPen(QPen(theme.seen, 3));
  for (const TimeNs time : observations_) mark(time);
  const TimeNs from = axis_.from(), to = axis_.to();
  const TimeNs step = label_step(to - from, width() - TimeAxis::kLeft - TimeAxis::kRight);
  painter.setPen(theme.muted);
  const QFont font = small_font(this->font());
  painter.setFont(font);
  const TimeNs first = (zone.local(from) + step - 1) / step * step;
  const bool several_days = zone.local(from) / kDay != zone.local(to) / kDay;
  for (TimeNs local = first; local <= zone.local(to); local += step) {
    const TimeNs t = zone.first_moment(local);
    const QString text = tick_text(t, step, zone, several_days && (local == first || local % kDay == 0));
    const double half = QFontMetricsF(font).horizontalAdvance(text) / 2 + 1;
    const double middle = std::clamp(x_of(t), half, width() - half);  // nothing is cut off at the sides
    painter.drawText(QRectF(middle - half, kTextY, 2 * half, 16), Qt::AlignCenter, text);
  }
}

void TimeTrack::paint_events(QPainter& painter) const {
  const Theme theme = Theme::of(palette());
  const auto object = browser_.selection().object();
  std::map<QRgb, double> last;  // dots that would cover each other are drawn once
  const auto dot = [&](const memory::Change& event, const QColor& color) {
    const double x = x_of(event.time);
    if (!shows(x)) return;
    const auto [before, is_first] = last.try_emplace(color.rgb(), x);
    if (!is_first && x - before->second < 1) return;
    before->second = x;
    painter.setBrush(color);
    painter.drawEllipse(QPointF(x, kEventsY), kDotRadius, kDotRadius);
  };
  painter.setPen(Qt::NoPen);
  for (const memory::Change& event : browser_.data()->events())
    if (object && !is_of(event, *object)) dot(event, theme.grid);
  last.clear();
  for (const memory::Change& event : browser_.data()->events())
    if (!object || is_of(event, *object)) dot(event, theme.of_event(event.kind));
}

void TimeTrack::paint_handle(QPainter& painter) const {
  const Theme theme = Theme::of(palette());
  const double x = std::clamp(x_of(browser_.selection().time()), TimeAxis::kLeft, width() - TimeAxis::kRight);
  painter.setPen(QPen(theme.accent, 2));
  painter.drawLine(QPointF(x, 2), QPointF(x, height()));
  painter.setPen(QPen(theme.panel, 2));
  painter.setBrush(theme.accent);
  painter.drawEllipse(QPointF(x, kAxisY), 7, 7);
}

}  // namespace loci::gui
