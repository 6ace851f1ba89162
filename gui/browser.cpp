#include "gui/browser.h"

#include <algorithm>
#include <vector>

#include "mapping/base/error.h"

namespace loci {
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

}  // namespace

Browser::Browser(QObject* parent) : QObject(parent) {
  connect(&selection_, &SelectionModel::selected, this, &Browser::selected);
  connect(&selection_, &SelectionModel::time_changed, this, &Browser::refresh);
}

void Browser::open(std::shared_ptr<const BrowserData> data) {
  data_ = std::move(data);
  selection_.clear();
  belief_ = {};
  {
    const QSignalBlocker quiet(selection_);
    selection_.set_time(data_ && !data_->scenes().empty() ? data_->scenes().back().time : 0);
  }
  Q_EMIT opened();
  refresh();
}

void Browser::renew(std::shared_ptr<const BrowserData> data) {
  const bool at_end = data_ && !data_->scenes().empty() && selection_.time() >= data_->scenes().back().time;
  data_ = std::move(data);
  if (at_end || selection_.time() == 0) {
    const QSignalBlocker quiet(selection_);
    if (!data_->scenes().empty()) selection_.set_time(data_->scenes().back().time);
  }
  Q_EMIT opened();
  refresh();
  Q_EMIT selected();
}

void Browser::refresh() {
  try {
    belief_ = data_ ? data_->belief_at(selection_.time()) : BelievedScene{};
  } catch (const Error& error) {
    belief_ = {};
    Q_EMIT failed(QString::fromUtf8(error.what()));
  }
  Q_EMIT belief_changed();
}

const SceneEntry* Browser::scene() const {
  return data_ ? data_->scene_at(selection_.time()) : nullptr;
}

const BelievedObject* Browser::selected_object() const {
  return selection_.object() ? belief_.find(*selection_.object()) : nullptr;
}

void Browser::step(int direction) {
  if (!data_) return;
  std::vector<TimeNs> times;
  for (const SceneEntry& scene : data_->scenes()) times.push_back(scene.time);
  selection_.set_time(neighbour(times, selection_.time(), direction));
}

void Browser::step_observation(int direction) {
  if (!data_) return;
  if (!selection_.object()) return step(direction);
  try {
    selection_.set_time(neighbour(data_->observations(*selection_.object()), selection_.time(), direction));
  } catch (const Error& error) {
    Q_EMIT failed(QString::fromUtf8(error.what()));
  }
}

void Browser::to_first() {
  if (data_ && !data_->scenes().empty()) selection_.set_time(data_->scenes().front().time);
}

void Browser::to_last() {
  if (data_ && !data_->scenes().empty()) selection_.set_time(data_->scenes().back().time);
}

}  // namespace loci
