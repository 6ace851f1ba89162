#include "apps/memory/memory_arguments.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace loci::apps {

void MemoryArguments::declare(ArgumentTable& table) {
  table.memory(memory);
  table.option("--at", &at, "What held at this time, e.g. \"08:30\", \"yesterday 9:00\"",
               {.default_text = "the end"});
  table.option("--known-at", &known_at, "As the memory knew it at this time, ISO 8601",
               {.default_text = "now"});
}

memory::AsOf MemoryArguments::as_of(const memory::Store& store) const {
  memory::AsOf as_of;
  if (!at.empty()) as_of.at = memory::TimeReader(store).read(at).last;
  // Known times are those of the machine's clock, so that "yesterday" is not about the last scene.
  if (!known_at.empty())
    as_of.known_at = memory::TimeReader(now(), store.time_zone_minutes()).read(known_at).last;
  return as_of;
}

void SpanArguments::declare(ArgumentTable& table) {
  table.option("--between", &between, "Two times", {.values = 2});
  table.option("--from", &from, "From this time on", {.excludes = {"--between"}});
  table.option("--to", &to, "Up to this time", {.excludes = {"--between"}});
}

std::optional<TimeNs> SpanArguments::first(const memory::Store& store) const {
  const std::string text = between.empty() ? from : between[0];
  return text.empty() ? std::nullopt : std::optional(memory::TimeReader(store).read(text).first);
}

std::optional<TimeNs> SpanArguments::last(const memory::Store& store) const {
  const std::string text = between.empty() ? to : between[1];
  return text.empty() ? std::nullopt : std::optional(memory::TimeReader(store).read(text).last);
}

std::string joined(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, " "));
}

Declare about_place() {
  return [](ArgumentTable& table) {
    struct Arguments {
      MemoryArguments memory;
      std::vector<std::string> place;
      std::string subject;
    };
    auto arguments = std::make_shared<Arguments>();
    arguments->memory.declare(table);
    table.positional("PLACE...", &arguments->place, "The place, e.g. table_1 or drawer_1");
    table.option("--object", &arguments->subject, "Only these objects");
    return [arguments](Session& session) {
      const memory::Store store = memory::Store::open_read(arguments->memory.memory);
      const memory::AsOf as_of = arguments->memory.as_of(store);
      answer_question(session, store,
                      memory::ContentsQuestion{joined(arguments->place), as_of, arguments->subject});
    };
  };
}

}  // namespace loci::apps
