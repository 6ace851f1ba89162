#include "gui/views/timeline/lane_view.h"

#include <QHelpEvent>
#include <QMouseEvent>
#include <QPainter>
#include <QScrollBar>
#include <QToolTip>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "gui/core/text.h"
#include "gui/core/theme.h"
#include "mapping/base/text/natural_order.h"
#include "memory/questions/events.h"

namespace loci::gui {
namespace {

constexpr int kRow = 19;
constexpr int kBar = 9;           // height of the coloured bar in a row
constexpr double kMinHalf = 1.5;  // of the mark of one scene, pixels
constexpr double kMaxHalf = 6;
constexpr double kEventRadius = 3;

const char* visibility_text(memory::ObjectStatus shown, bool place) {
  if (shown == memory::ObjectStatus::seen) return place ? "observed" : "seen";
  return shown == memory::ObjectStatus::missed ? "missed: its place was seen without it" : "not observed";
}

std::string what_of(const std::pair<int64_t, std::string>& lane) {
  return "lane " + std::to_string(lane.first) + " " + lane.second;
}

}  // namespace

LaneView::LaneView(Browser& browser, TimeAxis& axis, QWidget* parent)
    : QAbstractScrollArea(parent), browser_(browser), axis_(axis) {
  setFrameShape(QFrame::NoFrame);
  setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  // The axis ends at the same pixel above and here.
  setVerticalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  setFocusPolicy(Qt::NoFocus);
  viewport()->setAutoFillBackground(false);
  connect(&browser_, &Browser::opened, this, &LaneView::reload);
  connect(&browser_, &Browser::selected, this, &LaneView::follow_selection);
  connect(&browser_, &Browser::time_changed, viewport(), QOverload<>::of(&QWidget::update));
  connect(&axis_, &TimeAxis::changed, this, &LaneView::refresh);
  reload();
}

/// Whether all that has been read is true of this memory as well.
bool LaneView::goes_on_from(const OpenMemory& memory) const {
  return memory.info().path == memory_ && memory.info().runs == runs_;
}

void LaneView::reload() {
  const OpenMemory* memory = browser_.data();
  events_.clear();
  asked_.clear();
  if (memory == nullptr || !goes_on_from(*memory)) {
    lanes_.clear();
    shown_.clear();
  }
  memory_ = memory == nullptr ? "" : memory->info().path;
  runs_ = memory == nullptr ? 0 : memory->info().runs;
  if (memory != nullptr && !memory->scenes().empty()) {
    for (const memory::Change& event : memory->events())
      events_[event.object ? event.object->id : 0].push_back(&event);
    browser_.reader().read<Belief>(
        this, "lanes", Urgency::selection,
        [](const OpenMemory& source) { return source.belief_at(source.scenes().back().time); },
        [this](const Belief& belief) { show_lanes(belief); });
  }
  update_scroll_bar();
  refresh();
}

void LaneView::show_lanes(const Belief& belief) {
  lanes_.clear();
  std::set<std::string, NaturalOrder> places;
  for (const BelievedObject& object : belief.objects) {
    lanes_.push_back({object.object, {}, QString::fromStdString(belief.name_of(object))});
    if (const std::string place = belief.place_of(object); !place.empty()) places.insert(place);
  }
  for (const std::string& place : places) lanes_.push_back({0, place, QString::fromStdString(place)});
  update_scroll_bar();
  follow_selection();
}

void LaneView::scrollContentsBy(int, int) {
  refresh();
}

void LaneView::refresh() {
  backdrop_.forget();
  viewport()->update();
}

void LaneView::update_scroll_bar() {
  const int all = static_cast<int>(lanes_.size()) * kRow;
  verticalScrollBar()->setRange(0, std::max(0, all - viewport()->height()));
  verticalScrollBar()->setPageStep(viewport()->height());
  verticalScrollBar()->setSingleStep(kRow);
}

void LaneView::resizeEvent(QResizeEvent*) {
  update_scroll_bar();
}

int LaneView::top_of(size_t lane) const {
  return static_cast<int>(lane) * kRow - verticalScrollBar()->value();
}

QPoint LaneView::point_of(size_t lane, TimeNs time) const {
  return {static_cast<int>(std::lround(axis_.x_of(time, viewport()->width()))), top_of(lane) + kRow / 2};
}

const LaneView::Lane* LaneView::lane_at(int y) const {
  const int row = (y + verticalScrollBar()->value()) / kRow;
  return y >= 0 && row < static_cast<int>(lanes_.size()) ? &lanes_[static_cast<size_t>(row)] : nullptr;
}

bool LaneView::is_selected(const Lane& lane) const {
  const SelectionModel& selection = browser_.selection();
  return lane.object != 0 ? selection.object() == lane.object : lane.place == selection.place();
}

void LaneView::follow_selection() {
  for (size_t i = 0; i < lanes_.size(); ++i) {
    if (!is_selected(lanes_[i])) continue;
    const int value = verticalScrollBar()->value();
    const int top = static_cast<int>(i) * kRow;
    if (top < value || top + kRow > value + viewport()->height())
      verticalScrollBar()->setValue(top - viewport()->height() / 2);
  }
  refresh();
}

const std::vector<memory::ObjectStatus>& LaneView::visibility(const Lane& lane) {
  const Key key = {lane.object, lane.place};
  std::vector<memory::ObjectStatus>& known = shown_[key];
  const size_t all = browser_.data()->scenes().size();
  if (known.size() >= all || !asked_.insert(key).second) return known;
  browser_.reader().read<std::vector<memory::ObjectStatus>>(
      this, what_of(key), Urgency::rest,
      [key, first = known.size()](const OpenMemory& memory) {
        return key.first != 0 ? memory.visibility_of_object(key.first, first)
                              : memory.visibility_of_place(key.second, first);
      },
      [this, key](const std::vector<memory::ObjectStatus>& more) {
        asked_.erase(key);
        std::vector<memory::ObjectStatus>& looks = shown_[key];
        looks.insert(looks.end(), more.begin(), more.end());
        refresh();
      });
  return known;
}

void LaneView::forget_hidden() {
  std::set<Key> shown;
  for (size_t i = 0; i < lanes_.size(); ++i)
    if (top_of(i) > -kRow && top_of(i) < viewport()->height())
      shown.insert({lanes_[i].object, lanes_[i].place});
  for (auto key = asked_.begin(); key != asked_.end();)
    if (shown.contains(*key)) {
      ++key;
    } else {
      browser_.reader().forget(this, what_of(*key));
      key = asked_.erase(key);
    }
}

void LaneView::set_time_at(double x) {
  if (browser_.data() == nullptr || x < TimeAxis::kLeft - TimeAxis::kSnap) return;
  browser_.selection().set_time(snapped_time(*browser_.data(), axis_, x, viewport()->width()));
}

void LaneView::mousePressEvent(QMouseEvent* event) {
  const Lane* lane = lane_at(event->pos().y());
  if (event->button() != Qt::LeftButton || lane == nullptr) return;
  if (lane->object != 0)
    browser_.selection().select_object(lane->object);
  else
    browser_.selection().select_place(lane->place);
  set_time_at(event->localPos().x());
}

void LaneView::mouseMoveEvent(QMouseEvent* event) {
  if ((event->buttons() & Qt::LeftButton) != 0) set_time_at(event->localPos().x());
}

void LaneView::wheelEvent(QWheelEvent* event) {
  const int turned = event->angleDelta().y();
  if ((event->modifiers() & Qt::ControlModifier) != 0)
    axis_.zoom(turned > 0 ? 1 / TimeAxis::kZoomStep : TimeAxis::kZoomStep,
               axis_.time_at(event->position().x(), viewport()->width()));
  else
    verticalScrollBar()->setValue(verticalScrollBar()->value() - (turned > 0 ? kRow : -kRow));
  event->accept();
}

bool LaneView::viewportEvent(QEvent* event) {
  if (event->type() != QEvent::ToolTip || browser_.data() == nullptr)
    return QAbstractScrollArea::viewportEvent(event);
  const auto* help = static_cast<QHelpEvent*>(event);
  const Lane* lane = lane_at(help->pos().y());
  if (lane == nullptr || browser_.data()->scenes().empty()) return true;
  const TimeNs time = snapped_time(*browser_.data(), axis_, help->pos().x(), viewport()->width());
  const memory::SceneRow* scene = browser_.data()->scene_at(time);
  const auto number = static_cast<size_t>(scene - browser_.data()->scenes().data());
  const TimeZone& zone = browser_.data()->info().zone;
  const std::vector<memory::ObjectStatus>& known = visibility(*lane);
  if (number >= known.size()) return true;  // still being read
  QString text = lane->name + ": " + visibility_text(known[number], lane->object == 0) + " in the scene of " +
                 time_text(scene->time, zone).mid(11, 8);
  for (const memory::Change* entry : events_[lane->object])
    if (lane->object != 0 && entry->time == scene->time)
      text += "\n" + QString::fromStdString(to_text(*entry));
  QToolTip::showText(help->globalPos(), text, viewport());
  return true;
}

void LaneView::paintEvent(QPaintEvent*) {
  QPainter painter(viewport());
  painter.setRenderHint(QPainter::Antialiasing);
  if (browser_.data() == nullptr || lanes_.empty()) return;
  backdrop_.paint(*viewport(), painter, [this](QPainter& inside) { paint_lanes(inside); });
  const double now = axis_.x_of(browser_.selection().time(), viewport()->width());
  if (now < TimeAxis::kLeft - 1 || now > viewport()->width() - TimeAxis::kRight + 1) return;
  painter.setPen(QPen(Theme::of(palette()).accent, 2));
  painter.drawLine(QPointF(now, 0), QPointF(now, std::min(viewport()->height(), top_of(lanes_.size()))));
}

void LaneView::paint_lanes(QPainter& painter) {
  forget_hidden();
  std::vector<double> scene_x;
  scene_x.reserve(browser_.data()->scenes().size());
  for (const memory::SceneRow& scene : browser_.data()->scenes())
    scene_x.push_back(axis_.x_of(scene.time, viewport()->width()));
  for (size_t i = 0; i < lanes_.size(); ++i)
    if (const int top = top_of(i); top > -kRow && top < viewport()->height())
      paint_lane(painter, lanes_[i], top, scene_x);
}

void LaneView::paint_lane(QPainter& painter, const Lane& lane, int top, const std::vector<double>& scene_x) {
  const Theme theme = Theme::of(palette());
  const double right = viewport()->width() - TimeAxis::kRight;
  const QRectF name(8, top, TimeAxis::kLeft - 18, kRow);
  if (is_selected(lane)) {
    QColor marked = theme.accent;
    marked.setAlpha(45);
    painter.fillRect(QRectF(0, top, viewport()->width(), kRow), marked);
  }
  painter.setPen(lane.object != 0 ? theme.text : theme.muted);
  painter.drawText(name, Qt::AlignVCenter | Qt::AlignLeft,
                   fontMetrics().elidedText(lane.name, Qt::ElideRight, static_cast<int>(name.width())));
  const double bar_top = top + (kRow - kBar) / 2.0;
  painter.fillRect(QRectF(TimeAxis::kLeft, bar_top + kBar / 2.0 - 1, right - TimeAxis::kLeft, 2), theme.grid);
  paint_visibility(painter, lane, bar_top, scene_x);
  if (lane.object == 0) return;
  painter.setPen(QPen(theme.panel, 1));
  double last = -1;
  for (const memory::Change* event : events_[lane.object]) {
    const double x = axis_.x_of(event->time, viewport()->width());
    if (x < TimeAxis::kLeft - 1 || x > right + 1 || event->kind == memory::EventKind::appeared) continue;
    if (x - std::exchange(last, x) < 1) continue;
    painter.setBrush(theme.of_event(event->kind));
    painter.drawEllipse(QPointF(x, top + kRow / 2.0), kEventRadius + 1, kEventRadius + 1);
  }
}

void LaneView::paint_visibility(QPainter& painter, const Lane& lane, double top,
                                const std::vector<double>& scene_x) {
  const Theme theme = Theme::of(palette());
  const double right = viewport()->width() - TimeAxis::kRight;
  const std::vector<memory::ObjectStatus>& all = visibility(lane);
  const QColor seen = lane.object != 0 ? theme.seen : theme.accent;
  const auto begin = std::lower_bound(scene_x.begin(), scene_x.end(), TimeAxis::kLeft - 1);
  const auto end = std::upper_bound(begin, scene_x.end(), right + 1);
  const auto first = static_cast<size_t>(begin - scene_x.begin());
  const auto last = std::min(all.size(), static_cast<size_t>(end - scene_x.begin()));
  for (size_t i = first; i < last;) {
    // Scenes that fall into one pixel are drawn in the colour of their majority.
    const double x = scene_x[i];
    size_t next = i, seen_count = 0, missed_count = 0;
    for (; next < last && scene_x[next] < x + 1; ++next) {
      seen_count += all[next] == memory::ObjectStatus::seen;
      missed_count += all[next] == memory::ObjectStatus::missed;
    }
    if (seen_count + missed_count > 0) {
      double room = 2 * kMaxHalf;  // to the nearest other scene
      if (i > 0) room = std::min(room, x - scene_x[i - 1]);
      if (next < scene_x.size()) room = std::min(room, scene_x[next] - x);
      const double half = std::clamp(room / 2, kMinHalf, kMaxHalf);
      painter.fillRect(QRectF(x - half, top, 2 * half, kBar), missed_count > seen_count ? theme.gone : seen);
    }
    i = next;
  }
}

}  // namespace loci::gui
