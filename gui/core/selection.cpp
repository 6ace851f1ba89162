#include "gui/core/selection.h"

namespace loci::gui {

void SelectionModel::select_object(std::optional<int64_t> object) {
  if (object_ == object && place_.empty()) return;
  object_ = object;
  place_.clear();
  Q_EMIT selected();
}

void SelectionModel::select_place(const std::string& place) {
  if (place_ == place && !object_) return;
  place_ = place;
  object_.reset();
  Q_EMIT selected();
}

void SelectionModel::set_time(TimeNs time) {
  if (time_ == time) return;
  time_ = time;
  Q_EMIT time_changed();
}

void SelectionModel::set_known_at(std::optional<TimeNs> known_at) {
  if (known_at_ == known_at) return;
  known_at_ = known_at;
  Q_EMIT time_changed();
}

void SelectionModel::clear() {
  select_object(std::nullopt);
}

}  // namespace loci::gui
