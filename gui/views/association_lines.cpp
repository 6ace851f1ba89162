#include "gui/views/association_lines.h"

#include <QMouseEvent>
#include <QPainter>
#include <algorithm>

#include "gui/text.h"
#include "gui/theme.h"

namespace loci::gui {
namespace {

constexpr int kTitle = 22, kStamp = 18, kTile = 30, kStep = 36;
constexpr double kMinDrawn = 0.01;

/// The last observation before a scene that was taken for an object.
std::optional<std::pair<size_t, size_t>> last_seen(const std::vector<SceneDecisions>& scenes, size_t before,
                                                   int64_t object) {
  for (size_t i = before; i-- > 0;)
    for (size_t k = 0; k < scenes[i].observations.size(); ++k)
      if (object != 0 && scenes[i].observations[k].object == object) return std::pair(i, k);
  return std::nullopt;
}

}  // namespace

AssociationLines::AssociationLines(QWidget* parent) : QWidget(parent) {
  setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
  setToolTip(
      "Each thing seen, and what it may be the same as in earlier scenes: the darker, the more probable.\n"
      "A click chooses the object, on a time stamp the scene.");
}

void AssociationLines::set(std::vector<SceneDecisions> scenes, int zone_minutes) {
  scenes_ = std::move(scenes);
  zone_minutes_ = zone_minutes;
  lines_.clear();
  for (size_t i = 0; i < scenes_.size(); ++i)
    for (size_t k = 0; k < scenes_[i].observations.size(); ++k) {
      const DecidedObservation& observation = scenes_[i].observations[k];
      bool told = false;
      for (const ConsideredObject& other : observation.considered) {
        const auto earlier = last_seen(scenes_, i, other.object);
        if (!earlier || other.probability < kMinDrawn) continue;
        const bool chosen = other.object == observation.object;
        told |= chosen;
        lines_.push_back({i, k, earlier->first, earlier->second, other.probability, chosen});
      }
      if (told || !scenes_[i].observations[k].considered.empty()) continue;
      if (const auto earlier = last_seen(scenes_, i, observation.object))  // no reasoning was kept
        lines_.push_back({i, k, earlier->first, earlier->second, observation.probability, true});
    }
  std::stable_sort(lines_.begin(), lines_.end(),
                   [](const Line& a, const Line& b) { return a.probability < b.probability; });
  updateGeometry();
  update();
}

void AssociationLines::select(std::optional<int64_t> object) {
  selected_ = object;
  update();
}

QSize AssociationLines::sizeHint() const {
  size_t most = 0;
  for (const SceneDecisions& scene : scenes_) most = std::max(most, scene.observations.size());
  return most == 0 ? QSize(240, 0) : QSize(320, kTitle + kStamp + static_cast<int>(most) * kStep + 8);
}

QRect AssociationLines::tile(size_t scene, size_t observation) const {
  const double column = static_cast<double>(width()) / static_cast<double>(scenes_.size());
  const int x = static_cast<int>((static_cast<double>(scene) + 0.5) * column) - kTile / 2;
  return {x, kTitle + kStamp + static_cast<int>(observation) * kStep, kTile, kTile};
}

void AssociationLines::paintEvent(QPaintEvent*) {
  if (sizeHint().height() == 0) return;
  QPainter painter(this);
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setRenderHint(QPainter::SmoothPixmapTransform);
  const Theme theme = Theme::of(palette());
  QFont bold = font();
  bold.setBold(true);
  painter.setFont(bold);
  painter.setPen(theme.text);
  painter.drawText(QRect(0, 0, width(), kTitle), Qt::AlignVCenter | Qt::AlignLeft, "From scene to scene");
  for (const Line& line : lines_) {
    QColor color = theme.text;
    color.setAlphaF(std::clamp(line.probability, 0.06, 1.0));
    painter.setPen(QPen(color, line.chosen ? 2.5 : 1.5, line.chosen ? Qt::SolidLine : Qt::DashLine));
    const QRect from = tile(line.earlier_scene, line.earlier_observation),
                to = tile(line.scene, line.observation);
    painter.drawLine(QPointF(from.right() + 2, from.center().y()), QPointF(to.left() - 2, to.center().y()));
  }
  painter.setFont(small_font(font()));
  for (size_t i = 0; i < scenes_.size(); ++i) {
    const bool now = i + 1 == scenes_.size();
    painter.setPen(now ? theme.text : theme.muted);
    const int middle =
        static_cast<int>((static_cast<double>(i) + 0.5) * width() / static_cast<double>(scenes_.size()));
    painter.drawText(QRect(middle - 40, kTitle, 80, kStamp), Qt::AlignCenter,
                     time_text(scenes_[i].scene.time, zone_minutes_).mid(11, 10));
    for (size_t k = 0; k < scenes_[i].observations.size(); ++k) {
      const DecidedObservation& observation = scenes_[i].observations[k];
      const QRect area = tile(i, k);
      painter.fillRect(area, theme.panel);
      if (!observation.crop.empty())
        painter.drawImage(area.adjusted(1, 1, -1, -1), image_of(observation.crop));
      else
        painter.drawText(area, Qt::AlignCenter,
                         observation.object == 0 ? "?" : QString::number(observation.object));
      const bool selected = selected_ && observation.object == *selected_;
      painter.setPen(QPen(selected ? theme.accent : theme.grid, selected ? 3 : 1));
      painter.setBrush(Qt::NoBrush);
      painter.drawRect(area);
      painter.setPen(now ? theme.text : theme.muted);
    }
  }
}

void AssociationLines::mousePressEvent(QMouseEvent* event) {
  for (size_t i = 0; i < scenes_.size(); ++i)
    for (size_t k = 0; k < scenes_[i].observations.size(); ++k)
      if (tile(i, k).contains(event->pos()) && scenes_[i].observations[k].object != 0)
        return object_clicked(scenes_[i].observations[k].object);
  const double column =
      static_cast<double>(width()) / std::max<double>(1, static_cast<double>(scenes_.size()));
  const auto scene = static_cast<size_t>(event->pos().x() / column);
  if (event->pos().y() > kTitle && event->pos().y() < kTitle + kStamp && scene < scenes_.size())
    Q_EMIT scene_clicked(scenes_[scene].scene.time);
}

}  // namespace loci::gui
