#include "gui/views/lane_view.h"

#include <QHelpEvent>
#include <QMouseEvent>
#include <QPainter>
#include <QScrollBar>
#include <QToolTip>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>
#include <set>

#include "gui/text.h"
#include "gui/theme.h"
#include "mapping/base/error.h"

namespace loci {
namespace {

constexpr int kRow = 19;
constexpr int kBar = 9;             // height of the coloured bar in a row
constexpr double kLeastHalf = 1.5;  // of the mark of one scene, pixels
constexpr double kMostHalf = 6;
constexpr double kDotRadius = 3;
constexpr double kSnapPixels = 5;
constexpr double kZoomStep = 1.25;

const char* look_text(Look look, bool place) {
  switch (look) {
    case Look::seen:
      return place ? "looked at" : "seen";
    case Look::missed:
      return "looked for, not there";
    case Look::nothing:
      return "not observed";
  }
  return "";
}

}  // namespace

TimeNs snapped_time(const BrowserData& memory, const TimeAxis& axis, double x, int width) {
  const auto& scenes = memory.scenes();
  const TimeNs time = axis.time_at(x, width);
  const auto after = std::lower_bound(scenes.begin(), scenes.end(), time,
                                      [](const SceneEntry& scene, TimeNs t) { return scene.time < t; });
  TimeNs result = time;
  double nearest = kSnapPixels;
  for (auto scene = after == scenes.begin() ? after : after - 1; scene != scenes.end() && scene <= after;
       ++scene)
    if (const double distance = std::abs(axis.x_of(scene->time, width) - x); distance < nearest) {
      nearest = distance;
      result = scene->time;
    }
  return result;
}

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
  connect(&browser_, &Browser::belief_changed, this, &LaneView::refresh);
  connect(&axis_, &TimeAxis::changed, this, &LaneView::refresh);
  reload();
}

void LaneView::reload() {
  lanes_.clear();
  events_.clear();
  looks_.clear();
  const BrowserData* memory = browser_.data();
  if (memory != nullptr && !memory->scenes().empty()) try {
      std::set<std::string> places;
      for (const BelievedObject& object : memory->belief_at(memory->scenes().back().time).objects) {
        lanes_.push_back({object.id, {}, QString::fromStdString(object.name)});
        if (!object.place.empty()) places.insert(object.place);
      }
      for (const std::string& place : places) lanes_.push_back({0, place, QString::fromStdString(place)});
      for (const EventEntry& event : memory->events()) events_[event.object].push_back(&event);
    } catch (const Error& error) {
      Q_EMIT browser_.failed(QString::fromUtf8(error.what()));
    }
  update_scroll_bar();
  refresh();
}

void LaneView::refresh() {
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

const std::vector<Look>& LaneView::looks(const Lane& lane) {
  const auto [entry, is_new] = looks_.try_emplace({lane.object, lane.place});
  if (is_new) try {
      entry->second = lane.object != 0 ? browser_.data()->looks_for_object(lane.object)
                                       : browser_.data()->looks_at_place(lane.place);
    } catch (const Error& error) {
      Q_EMIT browser_.failed(QString::fromUtf8(error.what()));
    }
  entry->second.resize(browser_.data()->scenes().size(), Look::nothing);
  return entry->second;
}

void LaneView::set_time_at(double x) {
  if (browser_.data() == nullptr || x < TimeAxis::kLeft - kSnapPixels) return;
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
    axis_.zoom(turned > 0 ? 1 / kZoomStep : kZoomStep,
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
  const SceneEntry* scene = browser_.data()->scene_at(time);
  const auto number = static_cast<size_t>(scene - browser_.data()->scenes().data());
  const int zone = browser_.data()->info().zone_minutes;
  QString text = lane->name + ": " + look_text(looks(*lane)[number], lane->object == 0) +
                 " in the scene of " + time_text(scene->time, zone).mid(11, 8);
  for (const EventEntry* entry : events_[lane->object])
    if (lane->object != 0 && entry->time == scene->time) text += "\n" + QString::fromStdString(entry->text);
  QToolTip::showText(help->globalPos(), text, viewport());
  return true;
}

void LaneView::paintEvent(QPaintEvent*) {
  QPainter painter(viewport());
  painter.setRenderHint(QPainter::Antialiasing);
  if (browser_.data() == nullptr || lanes_.empty()) return;
  std::vector<double> scene_x;
  for (const SceneEntry& scene : browser_.data()->scenes())
    scene_x.push_back(axis_.x_of(scene.time, viewport()->width()));
  for (size_t i = 0; i < lanes_.size(); ++i)
    if (const int top = top_of(i); top > -kRow && top < viewport()->height())
      paint_lane(painter, lanes_[i], top, scene_x);
  const double now = axis_.x_of(browser_.selection().time(), viewport()->width());
  if (now < TimeAxis::kLeft - 1 || now > viewport()->width() - TimeAxis::kRight + 1) return;
  painter.setPen(QPen(Theme::of(palette()).accent, 2));
  painter.drawLine(QPointF(now, 0), QPointF(now, std::min(viewport()->height(), top_of(lanes_.size()))));
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
  const std::vector<Look>& all = looks(lane);
  for (size_t i = 0; i < scene_x.size(); ++i) {
    if (all[i] == Look::nothing || scene_x[i] < TimeAxis::kLeft - 1 || scene_x[i] > right + 1) continue;
    double room = 2 * kMostHalf;  // to the nearest other scene
    if (i > 0) room = std::min(room, scene_x[i] - scene_x[i - 1]);
    if (i + 1 < scene_x.size()) room = std::min(room, scene_x[i + 1] - scene_x[i]);
    const double half = std::clamp(room / 2, kLeastHalf, kMostHalf);
    const QColor color = all[i] == Look::missed ? theme.gone : lane.object != 0 ? theme.seen : theme.accent;
    painter.fillRect(QRectF(scene_x[i] - half, bar_top, 2 * half, kBar), color);
  }
  if (lane.object == 0) return;
  painter.setPen(QPen(theme.panel, 1));
  for (const EventEntry* event : events_[lane.object]) {
    const double x = axis_.x_of(event->time, viewport()->width());
    if (x < TimeAxis::kLeft - 1 || x > right + 1 || event->kind == "appeared") continue;
    painter.setBrush(theme.of_event(event->kind));
    painter.drawEllipse(QPointF(x, top + kRow / 2.0), kDotRadius + 1, kDotRadius + 1);
  }
}

}  // namespace loci
