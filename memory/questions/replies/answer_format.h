#pragma once

#include <string>
#include <vector>

#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "memory/questions/replies/answer_parts.h"
#include "memory/questions/time_parser.h"

/// The parts of which to_text() and to_json() of the answers are made.
namespace loci::memory::format {

std::string percent(double probability);
std::string size_text(const Vector3d& size);    ///< "8 x 8 x 10 cm"
std::string point_text(const Vector3d& p);      ///< "(1.00, 2.00, 0.80)"
std::string place_text(const PlaceRef& place);  ///< "on table_1", "in drawer_1_bottom"
std::string spot_text(const std::optional<PlaceRef>& place, const std::optional<Vector3d>& position);
std::string scene_text(const SceneRef& scene);  ///< "scene 3, frame 2"
/// "scenes 3, 4, 7 (frames 10, 11, 40)"; long lists are cut in the middle.
std::string scenes_text(const std::vector<SceneRef>& scenes);
std::string status_text(ObjectStatus status);  ///< "out of view"
/// "09:30 (after 08:00)".
std::string when_text(const Change& change, const TimeWriter& times);
/// "looked for on table_1 at 09:00 and not seen", of several looks "from 08:00 to 09:00". `where`
/// may be empty. The reason why something is taken for gone, in any answer.
std::string looked_for_text(const std::vector<TimeNs>& looks, const std::string& where,
                            const TimeWriter& times);
/// "drawer_1" for drawer_1_front_joint: what people call a joint, else the place that it moves, else the part
/// of the map.
std::string joint_in_words(const Change& change);
/// Where it is and on what evidence, as one sentence.
std::string belief_text(const ObjectBelief& belief, const TimeWriter& times);
/// Seen in one scene only and missed when its place was seen again: perhaps a false detection.
bool seen_once(const ObjectBelief& belief);
std::string lines_text(const std::vector<std::string>& lines);
/// Columns as wide as they need to be, the last one as it is.
std::string table_text(const std::vector<std::vector<std::string>>& rows);

}  // namespace loci::memory::format
