#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "memory/questions/names/names.h"
#include "memory/questions/replies/reply.h"

/// The parts that several replies share.
namespace loci::memory::replies {

/// Below this probability an object is more likely somewhere else.
inline constexpr double kLikely = 0.5;
/// From this probability on a sentence states it without "probably".
inline constexpr double kSure = 0.95;

/// "", "probably " or "perhaps ".
std::string adverb(double probability);
/// How a verdict on what is believed begins: "Yes", or "Yes, with 70 %" where it is not sure.
std::string with_probability(bool yes, double probability);
/// "At least 15 min, at most 2 h 0 min"; `most` unset = not known.
std::string bounds_text(TimeNs least, std::optional<TimeNs> most);

/// The change by which an object left its place, where that happened between the looks before and after the
/// time asked about.
std::optional<Change> left_around(Id object, TimeNs time, const Snapshot& snapshot);
/// Whether it is likely where it is believed to be, and the last look at its place did not miss it.
bool is_there(const ObjectBelief& object);
/// "on table_1", or a point where no place is known.
std::string spot_in_words(const std::optional<PlaceRef>& place, const std::optional<Vector3d>& position);
/// "tomatoes", and neither "glass" nor "table_1".
bool is_plural(std::string_view word);
/// "is" or "are", and "was" or "were" of a time that was asked about.
const char* is_or_was(const ReplyContext& context, size_t count = 1);
TimeSpan at_once(TimeNs time);
/// A name by Names without the place that qualifies it, for sentences that name the place anyway.
std::string without_place(std::string name);
/// As Names::subject(), likewise.
std::string bare_subject(const ObjectRef& object, const Names& names);
/// "The plate has gone; it was last seen on table_1 at 09:30."
std::string gone_text(const ObjectBelief& object, const Names& names, const TimeWriter& times);
/// "Because the milk was last seen on table_1 at 20:30."
std::string reason_of(const ObjectBelief& object, const Names& names, const ReplyContext& context);
/// The number that a sentence names ("two cups"); 0 = none.
size_t wanted_count(const Query& query);
/// What a number leaves out, said after it where there is room.
void add_out_of_sight(size_t count, Reply& reply);
/// A line of evidence for each object, as far as there is room.
void add_sightings(const std::vector<ObjectBelief>& objects, const Names& names, const ReplyContext& context,
                   Reply& reply);

/// The bounds of an event: "Between 08:00 and 09:30", "At 08:00" or, from kAlways on, "By 09:30".
std::string between_text(const TimeSpan& bounds, const TimeWriter& times);

}  // namespace loci::memory::replies
