#include "gui/data/browser.h"

#include <algorithm>
#include <vector>

#include "mapping/base/error.h"

namespace loci::gui {
namespace {

/// The neighbour of `time` in sorted `times`; `time` itself at the ends.
TimeNs neighbour(const std::vector<TimeNs>& times, TimeNs time, int direction) {
  if (direction > 0) {
    const auto next = std::upper_bound(times.begin(), times.end(), time);
    return next == times.end() ? time : *next;
  }
  const auto here = std::lower_bound(times.begin(), times.end(), time);
  return here == times.begin() ? time : *(here - 1);
}

/// More points make a frame slower than 20 ms under software rendering and show nothing new.
constexpr size_t kMaxPoints = 50000;

Moment read_moment(const OpenMemory& memory, TimeNs time, std::optional<TimeNs> known_at,
                   const Moment& before) {
  Moment moment;
  moment.belief = memory.belief_at(time, known_at);
  const memory::SceneRow* row = memory.scene_at(time);
  if (row == nullptr) return moment;
  if (before.content && before.content->scene.id == row->id) {
    moment.content = before.content;
    moment.cloud = before.cloud;
    return moment;
  }
  try {
    moment.content = std::make_shared<const SceneContent>(memory.scene(row->id));
    if (moment.content->map_from_camera)
      moment.cloud = std::make_shared<const ColoredCloud>(frame_cloud(*moment.content, kMaxPoints));
  } catch (const Error& error) {  // An image is broken: what is believed can be shown nevertheless.
    moment.problem = error.what();
  }
  return moment;
}

}  // namespace

Browser::Browser(QObject* parent) : QObject(parent) {
  connect(&selection_, &SelectionModel::selected, this, &Browser::selected);
  connect(&selection_, &SelectionModel::time_changed, this, &Browser::time_changed);
  connect(&selection_, &SelectionModel::time_changed, this, &Browser::refresh);
  connect(&reader_, &ReadQueue::failed, this, &Browser::failed);
}

void Browser::open(std::shared_ptr<const OpenMemory> data) {
  data_ = std::move(data);
  reader_.set_data(data_);
  selection_.clear();
  {
    const QSignalBlocker quiet(selection_);
    selection_.set_time(data_ && !data_->scenes().empty() ? data_->scenes().back().time : 0);
    selection_.set_known_at({});
  }
  moment_ = {};
  Q_EMIT opened();
  take({});
  refresh();
}

void Browser::renew(std::shared_ptr<const OpenMemory> data) {
  const bool at_end = data_ && !data_->scenes().empty() && selection_.time() >= data_->scenes().back().time;
  data_ = std::move(data);
  reader_.set_data(data_);
  if (at_end || selection_.time() == 0) {
    const QSignalBlocker quiet(selection_);
    if (!data_->scenes().empty()) selection_.set_time(data_->scenes().back().time);
  }
  Q_EMIT opened();
  Q_EMIT time_changed();
  read(Moment{});  // names in what was read may have changed
  Q_EMIT selected();
}

void Browser::refresh() {
  read(moment_);
}

void Browser::read(const Moment& before) {
  reader_.read<Moment>(
      this, "moment", Urgency::moment,
      [time = selection_.time(), known_at = selection_.known_at(), before](const OpenMemory& memory) {
        return read_moment(memory, time, known_at, before);
      },
      [this](Moment& moment) { take(std::move(moment)); }, Overtaken::delivered);
}

void Browser::take(Moment moment) {
  moment_ = std::move(moment);
  Q_EMIT belief_changed();
  if (!moment_.problem.empty()) Q_EMIT failed(QString::fromStdString(moment_.problem));
}

const memory::SceneRow* Browser::scene() const {
  return data_ ? data_->scene_at(selection_.time()) : nullptr;
}

const BelievedObject* Browser::selected_object() const {
  return selection_.object() ? belief().find(*selection_.object()) : nullptr;
}

void Browser::step(int direction) {
  if (!data_ || data_->scenes().empty()) return;
  const auto& scenes = data_->scenes();
  const auto earlier = [](const memory::SceneRow& scene, TimeNs t) { return scene.time < t; };
  const TimeNs now = selection_.time();
  const auto next = std::lower_bound(scenes.begin(), scenes.end(), direction > 0 ? now + 1 : now, earlier);
  if (direction > 0 ? next != scenes.end() : next != scenes.begin())
    selection_.set_time(direction > 0 ? next->time : (next - 1)->time);
}

void Browser::step_observation(int direction) {
  if (!selection_.object()) return step(direction);
  reader_.read<std::vector<TimeNs>>(
      this, "step", Urgency::moment,
      [object = *selection_.object()](const OpenMemory& memory) { return memory.observations(object); },
      [this, direction](const std::vector<TimeNs>& times) {
        selection_.set_time(neighbour(times, selection_.time(), direction));
      });
}

void Browser::to_first() {
  if (data_ && !data_->scenes().empty()) selection_.set_time(data_->scenes().front().time);
}

void Browser::to_last() {
  if (data_ && !data_->scenes().empty()) selection_.set_time(data_->scenes().back().time);
}

}  // namespace loci::gui
