#include "gui/views/map/map_pair.h"

#include <QLabel>
#include <QVBoxLayout>

#include "gui/core/text.h"
#include "gui/core/theme.h"

namespace loci::gui {
namespace {

constexpr int kHalf = 1000;  // of the width, whatever that is

std::map<int64_t, std::array<uint8_t, 3>> marks_of(const std::vector<Difference>& differences,
                                                   const QPalette& palette) {
  const Theme theme = Theme::of(palette);
  std::map<int64_t, std::array<uint8_t, 3>> marks;
  for (const Difference& difference : differences) {
    if (difference.kind == memory::EventKind::joint_changed) continue;
    const QColor color = theme.of_event(difference.kind);
    marks[difference.object] = {static_cast<uint8_t>(color.red()), static_cast<uint8_t>(color.green()),
                                static_cast<uint8_t>(color.blue())};
  }
  return marks;
}

}  // namespace

MapPair::MapPair(Browser& browser, MapBackend backend, QWidget* parent)
    : QSplitter(Qt::Horizontal, parent),
      browser_(browser),
      backend_(backend),
      now_(new MapView(browser, backend, this)),
      now_side_(column(now_, now_title_)) {
  setChildrenCollapsible(false);
  addWidget(now_side_);
  connect(now_, &MapView::warned, this, &MapPair::warned);
}

QWidget* MapPair::column(MapView* map, QLabel*& title) {
  auto* side = new QWidget(this);
  title = new QLabel(side);
  title->setContentsMargins(8, 3, 8, 3);
  title->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Fixed);
  title->hide();
  auto* layout = new QVBoxLayout(side);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(0);
  layout->addWidget(title);
  layout->addWidget(map, 1);
  return side;
}

void MapPair::make_other() {
  then_ = new MapView(then_browser_, backend_, this);
  then_->share_eye_of(*now_);
  then_side_ = column(then_, then_title_);
  then_title_->show();
  insertWidget(0, then_side_);
  then_->show();  // to change its parent has hidden it
  for (const MapLayer layer : {MapLayer::map, MapLayer::objects, MapLayer::labels, MapLayer::cloud,
                               MapLayer::camera, MapLayer::trace, MapLayer::cameras})
    then_->set_layer(layer, now_->scene().layer(layer));
  connect(then_, &MapView::warned, this, &MapPair::warned);
  connect(&then_browser_, &Browser::failed, &browser_, &Browser::failed);
  link_eyes();
  link_selection();
}

/// The map that is turned draws; the other one follows when its last image has another viewpoint.
void MapPair::link_eyes() {
  const auto follow = [this](MapView* moved, MapView* other) {
    connect(moved, &MapView::drawn, this, [this, moved, other] {
      if (is_pair() && other->drawn_eye() != moved->drawn_eye()) other->canvas().redraw();
    });
  };
  follow(now_, then_);
  follow(then_, now_);
}

void MapPair::link_selection() {
  connect(&browser_, &Browser::selected, this, [this] {
    const SelectionModel& chosen = browser_.selection();
    SelectionModel& other = then_browser_.selection();
    if (chosen.object() && there(*chosen.object()) != 0)
      other.select_object(there(*chosen.object()));
    else if (!chosen.place().empty())
      other.select_place(chosen.place());
    else
      other.clear();
  });
  connect(&then_browser_, &Browser::selected, this, [this] {
    const SelectionModel& chosen = then_browser_.selection();
    if (chosen.object() && here(*chosen.object()) > 0)
      browser_.selection().select_object(here(*chosen.object()));
    else if (!chosen.place().empty())
      browser_.selection().select_place(chosen.place());
  });
}

int64_t MapPair::there(int64_t here) const {
  for (const auto& [one, other] : other_.same)
    if (one == here) return other;
  return other_.is_same_memory ? here : 0;
}

int64_t MapPair::here(int64_t there) const {
  for (const auto& [one, other] : other_.same)
    if (other == there) return one;
  return other_.is_same_memory ? there : 0;
}

void MapPair::show_other(const OtherBelief& other, const std::vector<Difference>& differences) {
  if (other.memory == nullptr) return show_one();
  const bool fresh = !is_pair();
  if (then_ == nullptr) make_other();
  other_ = other;
  if (then_browser_.shared_data() != other.memory) then_browser_.open(other.memory);
  then_browser_.selection().set_known_at(other.known_at);
  then_browser_.selection().set_time(other.time);
  const TimeZone& zone = browser_.data()->info().zone;
  then_title_->setText("<b>Then</b> " + other.title.toHtmlEscaped());
  then_title_->setToolTip(other.title);
  now_title_->setText("<b>Now</b> " + time_text(browser_.selection().time(), zone));
  now_title_->show();
  const auto marks = marks_of(differences, palette());
  now_->set_marks(marks);
  std::map<int64_t, std::array<uint8_t, 3>> marks_there;
  for (const auto& [object, color] : marks)
    if (const int64_t number = there(object); number != 0) marks_there[number] = color;
  then_->set_marks(marks_there);
  then_side_->show();
  if (fresh) setSizes({kHalf, kHalf});
}

void MapPair::show_one() {
  if (then_ == nullptr) return;
  then_side_->hide();
  now_title_->hide();
  now_->set_marks({});
  then_browser_.open(nullptr);
  other_ = {};
}

void MapPair::set_layer(MapLayer layer, bool visible) {
  now_->set_layer(layer, visible);
  if (then_ != nullptr) then_->set_layer(layer, visible);
}

void MapPair::change_point_size(int steps) {
  now_->change_point_size(steps);
  if (then_ != nullptr) then_->change_point_size(steps);
}

}  // namespace loci::gui
