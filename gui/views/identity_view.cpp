#include "gui/views/identity_view.h"

#include <QHelpEvent>
#include <QLabel>
#include <QMouseEvent>
#include <QPainter>
#include <QScrollArea>
#include <QToolTip>
#include <QVBoxLayout>
#include <algorithm>
#include <array>

#include "gui/core/text.h"
#include "gui/core/theme.h"

namespace loci::gui {
namespace {

constexpr int kTitle = 22;
constexpr int kStamp = 18, kTile = 30, kStep = 36;
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
      "Each observation and the earlier ones that it may be the same object as: the darker, the more "
      "probable.\n"
      "A click chooses the object, on a time stamp the scene.");
}

void AssociationLines::set(std::vector<SceneDecisions> scenes, const TimeZone& zone) {
  scenes_ = std::move(scenes);
  zone_ = zone;
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
      if (const auto earlier = last_seen(scenes_, i, observation.object))  // no reasoning is stored
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
  painter.setFont(bold_font(font()));
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
                     time_text(scenes_[i].scene.time, zone_).mid(11, 10));
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

namespace {

constexpr int kNames = 96, kMaxCell = 34, kMinCell = 12, kGap = 10;
constexpr std::array<const char*, 2> kOtherRows = {"A new", "F false"};
constexpr std::array<const char*, 3> kOtherColumns = {"D", "M", "H"};
constexpr std::array<const char*, 3> kOtherColumnNames = {"gone", "missed, still there",
                                                          "hidden or out of view"};

}  // namespace

DecisionMatrix::DecisionMatrix(QWidget* parent) : QWidget(parent) {
  setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
}

void DecisionMatrix::set(SceneDecisions decisions) {
  decisions_ = std::move(decisions);
  rows_.clear();
  const auto add = [&](int64_t key, int64_t object, const std::string& name) {
    if (std::none_of(rows_.begin(), rows_.end(), [&](const Row& row) { return row.key == key; }))
      rows_.push_back({key, object, QString::fromStdString(name)});
  };
  for (const DecidedObservation& observation : decisions_.observations)
    for (const ConsideredObject& other : observation.considered) add(other.key, other.object, other.name);
  for (const UnseenObject& unseen : decisions_.unseen) add(unseen.key, unseen.object, unseen.name);
  updateGeometry();
  update();
}

int DecisionMatrix::cell_size() const {
  const int columns = static_cast<int>(decisions_.observations.size() + kOtherColumns.size());
  return std::clamp((width() - kNames - 16) / std::max(1, columns), kMinCell, kMaxCell);
}

int DecisionMatrix::panel_height(Panel panel) const {
  const size_t others = panel == Panel::is ? kOtherRows.size() : 0;
  return kTitle + cell_size() * static_cast<int>(1 + rows_.size() + others) + kGap;
}

int DecisionMatrix::panel_top(Panel panel) const {
  if (panel == Panel::alike) return 0;
  if (panel == Panel::near) return panel_height(Panel::alike);
  return panel_height(Panel::alike) + panel_height(Panel::near);
}

QSize DecisionMatrix::sizeHint() const {
  if (rows_.empty() || decisions_.observations.empty()) return {240, 0};
  return {320, panel_top(Panel::is) + panel_height(Panel::is)};
}

const ConsideredObject* DecisionMatrix::considered(size_t row, size_t column) const {
  for (const ConsideredObject& other : decisions_.observations[column].considered)
    if (other.key == rows_[row].key) return &other;
  return nullptr;
}

double DecisionMatrix::value(Panel panel, size_t row, size_t column) const {
  if (column >= decisions_.observations.size()) {
    if (panel != Panel::is || row >= rows_.size()) return -1;
    for (const UnseenObject& unseen : decisions_.unseen)
      if (unseen.key == rows_[row].key)
        return std::array{unseen.disappear, unseen.missed,
                          unseen.hidden}[column - decisions_.observations.size()];
    return -1;
  }
  const DecidedObservation& observation = decisions_.observations[column];
  if (row >= rows_.size()) return row == rows_.size() ? observation.appear : observation.clutter;
  const ConsideredObject* other = considered(row, column);
  if (other == nullptr) return -1;
  return panel == Panel::alike ? other->alike : panel == Panel::near ? other->near : other->probability;
}

void DecisionMatrix::paintEvent(QPaintEvent*) {
  if (sizeHint().height() == 0) return;
  QPainter painter(this);
  painter.setRenderHint(QPainter::SmoothPixmapTransform);
  for (const Panel panel : {Panel::alike, Panel::near, Panel::is}) paint_panel(painter, panel);
}

void DecisionMatrix::paint_panel(QPainter& painter, Panel panel) const {
  const Theme theme = Theme::of(palette());
  const int cell = cell_size(), top = panel_top(panel);
  painter.setFont(bold_font(font()));
  painter.setPen(theme.text);
  const char* title = panel == Panel::alike  ? "Looks alike"
                      : panel == Panel::near ? "Is near"
                                             : "Is the same (red: the assignment)";
  painter.drawText(QRect(0, top, width(), kTitle), Qt::AlignVCenter | Qt::AlignLeft, title);
  painter.setFont(small_font(font()));
  const size_t seen = decisions_.observations.size();
  const size_t columns = seen + (panel == Panel::is ? kOtherColumns.size() : 0);
  const size_t all_rows = rows_.size() + (panel == Panel::is ? kOtherRows.size() : 0);
  const auto place = [&](int row, int column) {
    return QRect(kNames + column * cell, top + kTitle + (row + 1) * cell, cell, cell);
  };
  for (size_t column = 0; column < columns; ++column) {
    const QRect head = place(-1, static_cast<int>(column));
    const cv::Mat none;
    const cv::Mat& crop = column < seen ? decisions_.observations[column].crop : none;
    painter.setPen(theme.muted);
    if (!crop.empty())
      painter.drawImage(head.adjusted(1, 1, -1, -1), image_of(crop));
    else
      painter.drawText(head, Qt::AlignCenter,
                       column < seen ? QString::number(decisions_.observations[column].number)
                                     : QString(kOtherColumns[column - seen]));
  }
  for (size_t row = 0; row < all_rows; ++row) {
    const QRect left(0, top + kTitle + static_cast<int>(row + 1) * cell, kNames - 6, cell);
    const QString name = row < rows_.size() ? rows_[row].name : QString(kOtherRows[row - rows_.size()]);
    painter.setPen(row < rows_.size() ? theme.text : theme.muted);
    painter.drawText(left, Qt::AlignVCenter | Qt::AlignRight,
                     painter.fontMetrics().elidedText(name, Qt::ElideMiddle, left.width()));
    for (size_t column = 0; column < columns; ++column) {
      if (row >= rows_.size() && column >= seen) continue;
      const QRect area = place(static_cast<int>(row), static_cast<int>(column)).adjusted(1, 1, -1, -1);
      const double amount = value(panel, row, column);
      painter.setPen(QPen(theme.grid, 1));
      painter.setBrush(Qt::NoBrush);
      if (amount >= 0) {  // white to black as on paper, whatever the theme
        const int level = static_cast<int>(255 - 225 * std::clamp(amount, 0.0, 1.0));
        painter.setBrush(QColor(level, level, level));
      }
      painter.drawRect(area);
      if (panel != Panel::is || column >= seen) continue;
      const DecidedObservation& observation = decisions_.observations[column];
      const bool chosen = row < rows_.size() ? rows_[row].key == observation.key && observation.key != 0 &&
                                                   observation.explanation != "appear"
                          : row == rows_.size() ? observation.explanation == "appear"
                                                : observation.explanation == "clutter";
      if (!chosen) continue;
      painter.setPen(QPen(QColor(215, 35, 35), 3));
      painter.setBrush(Qt::NoBrush);
      painter.drawRect(area.adjusted(1, 1, -1, -1));
    }
  }
}

std::optional<DecisionMatrix::Cell> DecisionMatrix::cell_at(const QPoint& point) const {
  if (sizeHint().height() == 0) return std::nullopt;
  const int cell = cell_size();
  for (const Panel panel : {Panel::is, Panel::near, Panel::alike}) {
    const int y = point.y() - panel_top(panel) - kTitle;
    if (y < 0) continue;
    const int row = y / cell - 1;
    const int column = point.x() < kNames ? -1 : (point.x() - kNames) / cell;
    const size_t rows = rows_.size() + (panel == Panel::is ? kOtherRows.size() : 0);
    const size_t columns = decisions_.observations.size() + (panel == Panel::is ? kOtherColumns.size() : 0);
    if (row >= static_cast<int>(rows) || column >= static_cast<int>(columns)) return std::nullopt;
    return Cell{panel, row, column};
  }
  return std::nullopt;
}

QString DecisionMatrix::text_at(const QPoint& point) const {
  const auto cell = cell_at(point);
  if (!cell || (cell->row < 0 && cell->column < 0)) return {};
  const size_t seen = decisions_.observations.size();
  const auto column = static_cast<size_t>(std::max(0, cell->column)),
             row = static_cast<size_t>(std::max(0, cell->row));
  if (cell->column >= static_cast<int>(seen))
    return cell->row >= static_cast<int>(rows_.size()) || value(cell->panel, row, column) < 0
               ? QString()
               : (cell->row < 0 ? QString() : rows_[row].name + ": ") + kOtherColumnNames[column - seen] +
                     ", " + percent_text(value(cell->panel, row, column));
  if (cell->column < 0) return row < rows_.size() ? rows_[row].name : QString();
  const DecidedObservation& observation = decisions_.observations[column];
  QString what =
      QString("Observation %1, taken for %2 (%3, %4)")
          .arg(observation.number)
          .arg(QString::fromStdString(observation.name), QString::fromStdString(observation.explanation),
               percent_text(observation.probability));
  if (cell->row < 0) return what;
  const double amount = value(cell->panel, row, column);
  if (amount < 0) return what + "\nnever considered to be " + rows_[row].name;
  if (row >= rows_.size())
    return what + (row == rows_.size() ? "\nsomething new, " : "\na false cluster, ") + percent_text(amount);
  const ConsideredObject& other = *considered(row, column);
  QString text = what + QString("\n%1: is it %2, looks alike %3, near %4 (50 % says nothing)")
                            .arg(rows_[row].name, percent_text(other.probability), percent_text(other.alike),
                                 percent_text(other.near));
  if (!other.against.empty()) text += "\nnot taken: " + QString::fromStdString(other.against);
  return text;
}

void DecisionMatrix::mousePressEvent(QMouseEvent* event) {
  const auto cell = cell_at(event->pos());
  if (!cell) return;
  int64_t object = 0;
  if (cell->column < 0 && cell->row >= 0 && cell->row < static_cast<int>(rows_.size()))
    object = rows_[static_cast<size_t>(cell->row)].object;
  else if (cell->column >= 0 && cell->column < static_cast<int>(decisions_.observations.size()))
    object = decisions_.observations[static_cast<size_t>(cell->column)].object;
  if (object != 0) Q_EMIT object_clicked(object);
}

bool DecisionMatrix::event(QEvent* event) {
  if (event->type() != QEvent::ToolTip) return QWidget::event(event);
  const auto* help = static_cast<QHelpEvent*>(event);
  QToolTip::showText(help->globalPos(), text_at(help->pos()), this);
  return true;
}

namespace {
constexpr size_t kScenes = 5;
}

IdentityView::IdentityView(Browser& browser, QWidget* parent)
    : Page(parent),
      browser_(browser),
      state_(new QLabel(this)),
      lines_(new AssociationLines),
      matrix_(new DecisionMatrix) {
  state_->setWordWrap(true);
  auto* inside = new QWidget;
  auto* column = new QVBoxLayout(inside);
  column->setContentsMargins(0, 0, 6, 0);
  column->addWidget(lines_);
  column->addWidget(matrix_);
  column->addStretch();
  auto* area = new QScrollArea(this);
  area->setWidget(inside);
  area->setWidgetResizable(true);
  area->setFrameShape(QFrame::NoFrame);
  area->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(8, 6, 2, 6);
  layout->addWidget(state_);
  layout->addWidget(area, 1);
  const auto choose = [this](qlonglong object) { browser_.selection().select_object(object); };
  connect(lines_, &AssociationLines::object_clicked, this, choose);
  connect(matrix_, &DecisionMatrix::object_clicked, this, choose);
  connect(lines_, &AssociationLines::scene_clicked, this,
          [this](qlonglong time) { browser_.selection().set_time(time); });
  connect(&browser_, &Browser::opened, this, &IdentityView::refresh);
  connect(&browser_, &Browser::belief_changed, this, &IdentityView::refresh);
  connect(&browser_, &Browser::selected, this, [this] { lines_->select(browser_.selection().object()); });
  refresh();
}

QString IdentityView::state() const {
  return state_->text();
}

void IdentityView::refresh() {
  if (!is_in_front()) return;
  const memory::SceneRow* scene = browser_.scene();
  if (scene == nullptr) {
    std::vector<SceneDecisions> none;
    show_decisions(none);
    return state_->setText("Open a memory to see how object identities were decided.");
  }
  browser_.reader().read<std::vector<SceneDecisions>>(
      this, "decisions", Urgency::selection,
      [id = scene->id](const OpenMemory& memory) { return memory.decisions(id, kScenes); },
      [this](std::vector<SceneDecisions>& scenes) { show_decisions(scenes); });
}

void IdentityView::show_decisions(std::vector<SceneDecisions>& scenes) {
  const TimeZone zone = browser_.data() == nullptr ? TimeZone() : browser_.data()->info().zone;
  const SceneDecisions last = scenes.empty() ? SceneDecisions{} : scenes.back();
  const size_t seen = last.observations.size();
  QString text = QString("Scene of %1: %2 observation%3")
                     .arg(time_text(last.scene.time, zone).mid(11, 10))
                     .arg(seen)
                     .arg(seen == 1 ? "" : "s");
  const auto count = [&](bool known, bool clutter) {
    return std::ranges::count_if(last.observations, [&](const DecidedObservation& observation) {
      return (observation.object != 0) == known &&
             (known || (observation.explanation == "clutter") == clutter);
    });
  };
  if (const auto known = count(true, false); known < static_cast<int64_t>(seen))
    text += QString(" (%1 of objects, %2 tentative, %3 taken for false clusters)")
                .arg(known)
                .arg(count(false, false))
                .arg(count(false, true));
  if (seen == 0)
    text += "; a scene with observations shows how identities were decided.";
  else if (!last.unreadable.empty())
    text += "; " + QString::fromStdString(last.unreadable);
  else if (!last.kept)
    text += "; its reasoning is not stored (loci-memory reason rebuilds it).";
  state_->setText(text);
  matrix_->set(last);
  lines_->set(std::move(scenes), zone);
  lines_->select(browser_.selection().object());
}

}  // namespace loci::gui
