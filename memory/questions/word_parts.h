#pragma once

#include <string>
#include <vector>

#include "memory/questions/words.h"

namespace loci::memory::words {

// What answers in words and in JSON are put together from.

std::string plural(size_t count, const char* word);  ///< "3 scenes"
std::string size_text(const Vector3d& size);         ///< "8 x 8 x 10 cm"
std::string place_text(const PlaceRef& place);       ///< "on table_1", "in drawer_1_bottom"
std::string point_text(const Vector3d& p);           ///< "(1.00, 2.00, 0.80)"
std::string spot_text(const std::optional<PlaceRef>& place, const std::optional<Vector3d>& position);
std::string scene_text(const SceneRef& scene);  ///< "scene 3, frame 2"
std::string scenes_text(const std::vector<SceneRef>& scenes);
std::string percent(double probability);
/// Where it is and why that is believed, as one sentence.
std::string state_text(const ObjectState& state, const TimeWriter& times);
std::string lines_text(const std::vector<std::string>& lines);
std::string status_text(const std::string& status);
/// Seen in one look only, and not there when somebody looked again: a false detection perhaps, or another
/// thing that looked different then.
bool seen_once(const ObjectState& state);
/// Columns as wide as they need to be, the last one as it is.
std::string table_text(const std::vector<std::vector<std::string>>& rows);

Json vector_json(const Vector3d& v);
Json scene_json(const SceneRef& scene);
Json scenes_json(const std::vector<SceneRef>& scenes);
Json object_json(const ObjectRef& object);
Json state_json(const ObjectState& state);
Json states_json(const std::vector<ObjectState>& states);

}  // namespace loci::memory::words
