#pragma once

#include <string>

#include "mapping/base/json_fwd.h"
#include "memory/questions/answers.h"
#include "memory/questions/people_time.h"
#include "memory/questions/spoken.h"

namespace loci::memory {

/// Answers as sentences that a person would like to read, times in the memory's zone.
std::string to_text(const WhereAnswer& answer, const TimeWriter& times);
std::string to_text(const HistoryAnswer& answer, const TimeWriter& times);
std::string to_text(const ContentsAnswer& answer, const TimeWriter& times);
std::string to_text(const WasAnswer& answer, const TimeWriter& times);
std::string to_text(const ChangesAnswer& answer, const TimeWriter& times);
std::string to_text(const ObjectsAnswer& answer, const TimeWriter& times);
std::string to_text(const ScenesAnswer& answer, const TimeWriter& times);
std::string to_text(const TimelineAnswer& answer, const TimeWriter& times);
std::string to_text(const UsualAnswer& answer, const TimeWriter& times);
std::string to_text(const KeptAnswer& answer, const TimeWriter& times);
std::string to_text(const TaskAnswer& answer, const TimeWriter& times);
std::string to_text(const NearAnswer& answer, const TimeWriter& times);
std::string to_text(const TogetherAnswer& answer, const TimeWriter& times);
std::string to_text(const MissingAnswer& answer, const TimeWriter& times);
std::string to_text(const KindAnswer& answer, const TimeWriter& times);
std::string to_text(const LifecycleAnswer& answer, const TimeWriter& times);
std::string to_text(const NextLookAnswer& answer, const TimeWriter& times);
std::string to_text(const LikeAnswer& answer, const TimeWriter& times);
std::string to_text(const AboutAnswer& answer, const TimeWriter& times);
std::string to_text(const RoomAnswer& answer, const TimeWriter& times);
std::string to_text(const OpensAnswer& answer, const TimeWriter& times);
std::string to_text(const AnyAnswer& answer, const TimeWriter& times);
std::string to_text(const SpokenAnswer& answer, const TimeWriter& times);

/// The same structs as JSON; times ISO 8601, UTC; lengths in metres; unset fields are left out.
Json to_json(const WhereAnswer& answer);
Json to_json(const HistoryAnswer& answer);
Json to_json(const ContentsAnswer& answer);
Json to_json(const WasAnswer& answer);
Json to_json(const ChangesAnswer& answer);
Json to_json(const ObjectsAnswer& answer);
Json to_json(const ScenesAnswer& answer);
Json to_json(const TimelineAnswer& answer);
Json to_json(const UsualAnswer& answer);
Json to_json(const KeptAnswer& answer);
Json to_json(const TaskAnswer& answer);
Json to_json(const NearAnswer& answer);
Json to_json(const TogetherAnswer& answer);
Json to_json(const MissingAnswer& answer);
Json to_json(const KindAnswer& answer);
Json to_json(const LifecycleAnswer& answer);
Json to_json(const NextLookAnswer& answer);
Json to_json(const LikeAnswer& answer);
Json to_json(const AboutAnswer& answer);
Json to_json(const RoomAnswer& answer);
Json to_json(const OpensAnswer& answer);
Json to_json(const AnnotationSupport& evidence);
Json to_json(const AnyAnswer& answer);
Json to_json(const SpokenAnswer& answer);

/// One change in words, without its time: "object_3 (red) moved from table_1 to counter_1".
std::string change_text(const Change& change);
/// "object_3 (red, the tea cup)".
std::string object_text(const ObjectRef& object);

}  // namespace loci::memory
