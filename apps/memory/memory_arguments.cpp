#include "apps/memory/memory_arguments.h"

#include <fmt/ranges.h>

#include "memory/fleet/fleet_replica.h"

namespace loci::apps {

void MemoryArguments::declare(ArgumentTable& table) {
  table.memory(memory);
  table.option("--at TIME", &at, "Valid time: \"08:30\", \"yesterday 9:00\"", {.default_text = "the end"});
  table.option("--known-at TIME", &known_at, "Transaction time: what the memory contained then, ISO 8601",
               {.default_text = "now"});
}

memory::AsOf MemoryArguments::as_of(const memory::Store& store) const {
  return memory::read_as_of(store, at, known_at);
}

void SpanArguments::declare(ArgumentTable& table) {
  table.option("--between TIME TIME", &between, "Between two times", {.values = 2});
  table.option("--from TIME", &from, "From this time on", {.excludes = {"--between"}});
  table.option("--to TIME", &to, "Until this time", {.excludes = {"--between"}});
}

Span SpanArguments::read(const memory::Store& store) const {
  const memory::TimeReader times(store);
  const std::string& begin = between.empty() ? from : between[0];
  const std::string& end = between.empty() ? to : between[1];
  Span span;
  if (!begin.empty()) span.first = times.read(begin).first;
  if (!end.empty()) span.last = times.read(end).last;
  memory::check_period(span.first, span.last);
  return span;
}

std::filesystem::path memory_file(const std::string& memory, Session& session) {
  return memory_source(memory, session)();
}

std::function<std::filesystem::path()> memory_source(const std::string& memory, Session& session) {
  if (!memory::is_fleet_url(memory)) return [memory] { return std::filesystem::path(memory); };
  auto replica = std::make_shared<memory::FleetReplica>(memory, cache_folder() / "fleet");
  return [replica, &session] { return replica->update(session.progress(), memory::kFreshReplica_s); };
}

memory::Store open_memory(const std::string& memory, Session& session) {
  return memory::Store::open_read(memory_file(memory, session));
}

memory::Store open_to_change(const std::string& memory, Session& session) {
  memory::Store::open_read(memory);
  memory::Store store = memory::Store::open_write(memory);
  if (!store.kept_before_migration().empty())
    session.warnings().add("was migrated; as it was it is kept in " + store.kept_before_migration().string(),
                           {memory, 0, {}});
  return store;
}

}  // namespace loci::apps
