#include "gui/views/time_axis.h"

#include <algorithm>
#include <cmath>

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
  const TimeNs span = to_ - from_;
  if (time >= from_ && time <= to_) return;
  const TimeNs from = std::clamp(time - span / 2, first_, std::max(first_, last_ - span));
  show(from, from + span);
}

}  // namespace loci::gui
