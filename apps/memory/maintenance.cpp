// The memory file: reason, resolve, verify, stat, forget, retain, merge.

#include <fmt/format.h>
#include <algorithm>
#include <charconv>
#include <cmath>

#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"
#include "mapping/base/math/math.h"
#include "mapping/base/output_file.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "memory/edits/edits.h"
#include "memory/edits/forget.h"
#include "memory/identity/vector_file.h"
#include "memory/questions/snapshot.h"
#include "memory/reasoning/reason.h"
#include "memory/recorder/checkpoint.h"
#include "memory/store/erasure/forgotten_tokens.h"
#include "memory/store/erasure/retention.h"
#include "memory/store/memory_file.h"
#include "memory/store/rows/merge.h"

namespace loci::apps {

Command reason_command() {
  return {
      "reason",
      "Repeat the reasoning over all scenes, with other parameters",
      {"loci-memory reason -m demo-output/memory.loci -o demo-output/other.loci --move-time-s 7200 --compare",
       "loci-memory reason -m demo-output/memory.loci --compare-with demo-output/other.loci --json"},
      [](ArgumentTable& table) {
        struct Arguments {
          std::string memory, output, compare_with, now;
          bool compare = false;
          memory::belief::BeliefOptions options;
        };
        auto arguments = std::make_shared<Arguments>();
        table.memory(arguments->memory);
        table.option("-o,--output MEMORY", &arguments->output, "Memory for the new history");
        table.flag("--compare", arguments->compare, "Compare the two histories afterwards",
                   {.needs = {"--output"}});
        table.option("--compare-with MEMORY", &arguments->compare_with,
                     "Only compare with this earlier result of `reason`", {.excludes = {"--output"}});
        table.now(arguments->now);
        table.options(table_of(arguments->options), "Reasoning");
        return [arguments](Session& session) {
          const memory::Store store = memory::Store::open_read(arguments->memory);
          memory::WriteOptions write;
          if (!arguments->now.empty()) write.now = parse_time(arguments->now);
          std::string text;
          Json json = Json::object();
          if (arguments->output.empty() && arguments->compare_with.empty())
            throw UsageError("--output or --compare-with is required");
          if (!arguments->output.empty()) {
            const memory::ReasonResult result = reason(store, arguments->output, arguments->options, write,
                                                       session.progress(), memory::known_identities(store));
            text = result.summary() + "\n";
            json = result.report();
          }
          const std::string& other = arguments->compare ? arguments->output : arguments->compare_with;
          if (!other.empty()) {
            const memory::HistoryDifference difference =
                compare_histories(store, memory::Store::open_read(other));
            text += difference.text();
            json["difference"] = difference.to_json();
          }
          session.answer(text, json);
        };
      }};
}

Command resolve_command() {
  return {"resolve",
          "Solve one data-association problem exactly",
          {"loci-memory resolve tests/data/identity/two_by_two.json",
           "loci-memory resolve tests/data/identity/two_by_two.json --best 3"},
          [](ArgumentTable& table) {
            struct Arguments {
              std::string file;
              int best = 5;
            };
            auto arguments = std::make_shared<Arguments>();
            table.positional("FILE", &arguments->file, "The problem, JSON");
            table.option("--best N", &arguments->best, "Number of ranked assignments to list",
                         {.min = 0, .max = 10000});
            return [arguments](Session& session) {
              memory::IdentityVector vector =
                  memory::identity_vector_from_json(read_json(arguments->file), arguments->file);
              vector.options.best = arguments->best;
              const Stopwatch watch;
              const memory::IdentitySolution solution = solve(vector.problem, vector.options);
              session.timing("resolve", watch.seconds());
              if (solution.gate_bound > std::max(1e-6, 2 * vector.options.gate))
                session.warnings().add(
                    "probabilities are approximate: the problem is too large to solve without dropping pairs",
                    {arguments->file, 0, {}});
              const Json answer = to_json(solution);
              session.answer(answer.dump(), answer);
            };
          }};
}

namespace {

Json report_json(const memory::VerifyReport& report) {
  Json json = {{"ok", report.problems.empty()}, {"format", fmt::format("{}.{}", report.major, report.minor)}};
  json["problems"] = report.problems;
  json["rows"] = Json::object();
  for (const auto& [table, count] : report.counts) json["rows"][table] = count;
  return json;
}

std::string report_text(const memory::VerifyReport& report) {
  std::string text =
      fmt::format("The memory is {}, format {}.{}:", report.problems.empty() ? "sound" : "NOT sound",
                  report.major, report.minor);
  for (const auto& [table, count] : report.counts)
    if (count > 0) text += fmt::format(" {} {},", count, table);
  text.back() = '.';
  for (const std::string& problem : report.problems) text += "\n  " + problem;
  return text;
}

std::vector<std::string> copies_beside(const std::string& memory) {
  std::vector<std::string> copies;
  for (const std::filesystem::path& copy : memory::kept_copies(memory)) copies.push_back(copy.string());
  return copies;
}

void verify_forgotten(Session& session, const std::filesystem::path& memory, const std::string& file) {
  const Json json = read_json(file);
  const memory::ForgottenTokens tokens =
      memory::tokens_from_json(json.is_object() ? json.value("loci_forgotten", Json()) : Json(), file);
  std::vector<std::string> left = find_forgotten(memory, tokens, session.progress());
  for (const std::string& copy : copies_beside(memory.string()))
    if (!find_forgotten(copy, tokens, session.progress()).empty())
      left.push_back(copy + ", kept before a migration, has it: delete it");
  const size_t searched =
      tokens.texts.size() + tokens.hashes.size() + tokens.numbers.size() + tokens.images.size();
  if (searched == 0)
    throw Error("there are no tokens: nothing can be proven", {file, 0, {}},
                "what was erased had only short words, and numbers that others have, too");
  std::string text = left.empty() ? fmt::format("None of {} is left.", counted(searched, "token"))
                                  : fmt::format("Of {}, this is left:", counted(searched, "token"));
  for (const std::string& line : left) text += "\n  " + line;
  session.answer(text, {{"ok", left.empty()}, {"tokens", searched}, {"left", left}});
  if (!left.empty())
    throw Error(
        "not everything is forgotten", {memory, 0, {}},
        "close programs that have it open; forget what a column is about, or with --between the scenes of an "
        "image; what is only in the bytes of the file goes with loci-memory retain, which writes it anew");
}

}  // namespace

Command verify_command() {
  return {
      "verify",
      "Check a memory file and repair derived rows",
      {"loci-memory verify -m demo-output/memory.loci",
       "loci-memory verify --repair -m demo-output/memory.loci --json"},
      [](ArgumentTable& table) {
        struct Arguments {
          std::string memory, forgotten;
          bool repair = false;
        };
        auto arguments = std::make_shared<Arguments>();
        table.memory(arguments->memory);
        table.option("--forgotten FILE", &arguments->forgotten,
                     "Search the bytes of the file for the tokens that `forget --tokens` wrote",
                     {.excludes = {"--repair"}});
        table.flag("--repair", arguments->repair,
                   "Rebuild the derived rows (stays, words, marks of objects) where they are wrong");
        return [arguments](Session& session) {
          if (!arguments->forgotten.empty())
            return verify_forgotten(session, memory_file(arguments->memory, session), arguments->forgotten);
          memory::VerifyReport report;
          std::optional<Error> unreadable;
          {
            const memory::Store store = open_memory(arguments->memory, session);
            report = store.verify(session.progress());
            unreadable = memory::unreadable_belief(store);
          }
          const size_t repaired = arguments->repair ? report.derived_problems.size() : 0;
          if (repaired > 0) {
            memory::Store store = memory::Store::open_write(arguments->memory);
            const memory::Id run = store.begin_run("loci-memory verify --repair", "{}");
            store.derive();
            store.finish_run(run);
            report = store.verify(session.progress());
          }
          Json json = report_json(report);
          std::string text = report_text(report);
          if (unreadable) {
            text += fmt::format("\n  It can be read, but not continued or corrected: {} ({})",
                                unreadable->message(), unreadable->hint());
            json["not_continued"] = {{"because", unreadable->message()}, {"hint", unreadable->hint()}};
          }
          if (arguments->repair) {
            json["repaired"] = repaired;
            text = fmt::format("{} problems repaired. ", repaired) + text;
          }
          session.answer(text, json);
          if (!report.problems.empty())
            throw Error(fmt::format("{} problems found", report.problems.size()), {arguments->memory, 0, {}},
                        report.derived_problems.size() == report.problems.size()
                            ? "loci-memory verify --repair rebuilds them"
                            : "restore it from a copy");
        };
      }};
}

Command stat_command() {
  return {
      "stat",
      "Show rows and bytes of the file by table",
      {"loci-memory stat -m demo-output/memory.loci", "loci-memory stat -m demo-output/memory.loci --json"},
      [](ArgumentTable& table) {
        auto memory = std::make_shared<std::string>();
        table.memory(*memory);
        return [memory](Session& session) {
          std::string text = fmt::format("{:24} {:>12} {:>14}\n", "table, with its indexes", "rows", "bytes");
          Json tables = Json::object();
          int64_t bytes = 0;
          for (const memory::Store::TableSize& size : open_memory(*memory, session).statistics()) {
            text += fmt::format("{:24} {:12} {:14}\n", size.table, size.rows, size.bytes);
            tables[size.table] = {{"rows", size.rows}, {"bytes", size.bytes}};
            bytes += size.bytes;
          }
          text += fmt::format("{:24} {:>12} {:14}", "all", "", bytes);
          session.answer(text, {{"bytes", bytes}, {"tables", tables}});
        };
      }};
}

Command time_zone_command() {
  return {"time-zone",
          "Show or set the time zone in which a memory reads and writes people's times",
          {"loci-memory time-zone -m demo-output/memory.loci",
           "loci-memory time-zone UTC -m demo-output/memory.loci"},
          [](ArgumentTable& table) {
            struct Arguments {
              std::string memory, zone;
            };
            auto arguments = std::make_shared<Arguments>();
            table.positional("[ZONE]", &arguments->zone, "The zone: Europe/Berlin, UTC, +02:00");
            table.memory(arguments->memory);
            return [arguments](Session& session) {
              if (!arguments->zone.empty()) {
                const std::string name = TimeZone::named(arguments->zone).name();
                open_to_change(arguments->memory, session).set_meta("time_zone", name);
              }
              const memory::Store store = open_memory(arguments->memory, session);
              const std::string name = store.time_zone().name();
              session.answer(name, {{"time_zone", name}});
            };
          }};
}

namespace {

/// What a request names: an object, a place, or two times.
memory::ForgetRequest forget_request(const memory::Store& store, const std::string& name,
                                     const SpanArguments& arguments) {
  const Span span = arguments.read(store);
  memory::ForgetRequest request{.from = span.first, .to = span.last};
  const bool interval = request.from && request.to;
  if (name.empty() != interval || request.from.has_value() != request.to.has_value())
    throw UsageError("either NAME (object_12, counter_1) or --between is required");
  if (name.empty()) return request;
  request.object = memory::object_id(name);
  if (request.object) return request;
  const std::vector<memory::PlaceRow> places = memory::Snapshot(store, {}).places_called(name);
  if (places.size() != 1) {
    // What is erased is lost: a name that may come to mean another object is not enough.
    std::vector<std::string> meant;
    for (const memory::Id object : memory::Snapshot(store, {}).find_objects(name))
      meant.push_back(memory::object_name(object));
    throw Error(fmt::format("'{}' is neither an object, as object_12, nor a place", name), {},
                meant.empty() ? "loci-memory objects and loci-memory room list them"
                              : "give its number: " + joined(meant, ", "));
  }
  request.place = places.front().id;
  return request;
}

std::string forgotten_text(const memory::ForgetResult& result) {
  std::string text = fmt::format("Forgotten: {}, {}; {} changed.", counted(size_t(result.objects), "object"),
                                 counted(size_t(result.observations), "observation"),
                                 counted(size_t(result.scenes), "scene"));
  if (result.erased.empty()) return text + "\nErased: nothing.";
  text += "\nErased:";
  for (const auto& [kind, count] : result.erased) text += fmt::format(" {} {},", count, kind);
  text.back() = '.';
  if (result.erased.contains(memory::kUnreadableBelief))
    text += "\nWithout that belief, which cannot be rewritten, no run goes on with this memory.";
  return text;
}

}  // namespace

Command forget_command() {
  return {
      "forget",
      "Erase an object, what is stated about a place, or everything between two times",
      {"loci-memory forget object_1 -m demo-output/memory.loci -o demo-output/remaining.loci",
       "loci-memory forget --between 08:00 08:30 -m demo-output/memory.loci -o "
       "demo-output/without_breakfast.loci "
       "--json"},
      [](ArgumentTable& table) {
        struct Arguments {
          std::string memory, name, output, tokens;
          SpanArguments span;
        };
        auto arguments = std::make_shared<Arguments>();
        table.positional("[NAME]", &arguments->name, "The object, as object_12, or a place");
        table.memory(arguments->memory);
        table.option("-o,--output MEMORY", &arguments->output, "Erase in a copy; the memory stays as it is");
        table.option("--tokens FILE", &arguments->tokens,
                     "Write what must not be found any more, for verify --forgotten; delete it afterwards",
                     {.replaces = true});
        arguments->span.declare(table);
        return [arguments](Session& session) {
          const auto request = [&] {
            return forget_request(memory::Store::open_read(arguments->memory), arguments->name,
                                  arguments->span);
          }();
          OutputOptions secret = session.outputs();
          secret.mode = 0600;
          const memory::ForgetResult result =
              memory::forget(arguments->memory, request, arguments->output, session.progress());
          if (!arguments->tokens.empty())
            write_output(arguments->tokens, Json{{"loci_forgotten", to_json(result.tokens)}}.dump(1) + "\n",
                         secret);
          const std::vector<std::string> copies = copies_beside(arguments->memory);
          for (const std::string& copy : copies)
            session.warnings().add("was kept before a migration and has what was forgotten: delete it",
                                   {copy, 0, {}});
          session.answer(forgotten_text(result), {{"objects", result.objects},
                                                  {"observations", result.observations},
                                                  {"scenes", result.scenes},
                                                  {"erased", result.erased},
                                                  {"copies", copies}});
        };
      }};
}

namespace {

/// "x,y,z,yaw_deg".
memory::FrameChange frame_from(const std::string& text) {
  constexpr double kMaxValue = 1e5;  // metres: no home is farther from its map's origin
  std::vector<double> values;
  const char *at = text.data(), *const end = text.data() + text.size();
  while (at < end) {
    double value = 0;
    const auto read = std::from_chars(at, end, value);
    if (read.ec != std::errc() || !(std::abs(value) <= kMaxValue) || (read.ptr < end && *read.ptr != ','))
      break;
    values.push_back(value);
    at = read.ptr + 1;
  }
  if (values.size() != 4 || at <= end)
    throw Error("'" + text + "' is not a transform", {},
                "write --transform x,y,z,yaw_deg, for example 0,0,0,0");
  return {Vector3d(values[0], values[1], values[2]), values[3] / 180 * kPi};
}

/// "90s", "12h", "30d", "2y".
std::optional<double> age_from(const std::string& text) {
  if (text.empty()) return std::nullopt;
  double number = 0;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, number);
  const std::string unit(read.ptr, end);
  for (const auto& [name, seconds] :
       {std::pair{"s", 1.0}, {"h", 3600.0}, {"d", 86400.0}, {"y", 365 * 86400.0}})
    if (read.ec == std::errc() && unit == name && number >= 0 && number < 1e6) return number * seconds;
  throw Error("'" + text + "' is not a duration", {}, "write 90s, 12h, 30d or 2y");
}

}  // namespace

Command merge_command() {
  return {
      "merge",
      "Merge two memories of one home; of scenes that both have, the first one's decisions hold",
      {"loci-memory merge demo-output/memory.loci demo-output/memory.loci -o demo-output/merged.loci",
       "loci-memory merge demo-output/memory.loci demo-output/memory.loci --transform 0,0,0,0 -o "
       "demo-output/merged_same_frame.loci --json"},
      [](ArgumentTable& table) {
        struct Arguments {
          std::string first, second, output, transform, reason;
        };
        auto arguments = std::make_shared<Arguments>();
        table.positional("MEMORY", &arguments->first, "The memory whose map frame the result has");
        table.positional("OTHER", &arguments->second, "The memory to add");
        table.output("MEMORY", &arguments->output, "The merged memory");
        table.option("--transform POSE", &arguments->transform,
                     "Pose of the second map frame in the first: x,y,z,yaw_deg; 0,0,0,0 for the same frame");
        table.option("--reason MEMORY", &arguments->reason,
                     "Reason over the merged memory, into this one: objects seen in both become one");
        return [arguments](Session& session) {
          std::optional<memory::FrameChange> frame;
          if (!arguments->transform.empty()) frame = frame_from(arguments->transform);
          const memory::MergeResult result =
              merge(memory_file(arguments->first, session), memory_file(arguments->second, session),
                    arguments->output, frame, session.progress());
          std::string text = fmt::format(
              "{} with {} of {} and {} came in; known before: {}.", counted(size_t(result.scenes), "scene"),
              counted(size_t(result.observations), "observation"), counted(size_t(result.objects), "object"),
              counted(size_t(result.facts), "fact"), counted(size_t(result.known_scenes), "scene"));
          if (result.forgotten > 0)
            text += fmt::format("\n{} stay away: one of the memories has forgotten them.",
                                counted(size_t(result.forgotten), "observation"));
          if (result.known_scenes > 0)
            text += fmt::format("\nOf scenes that both have, the observations and decisions of {} hold.",
                                arguments->first);
          for (const std::string& edit : result.left_edits)
            text += fmt::format("\nA correction of the second memory stays behind: {}.", edit);
          Json renamed = Json::object();
          for (const auto& [old, name] : result.renamed) {
            text += fmt::format("\n{} of the second memory lies elsewhere: it is called {} now.", old, name);
            renamed[old] = name;
          }
          if (result.reasoning > 0)
            text += fmt::format("\nThe reasoning of {}, which is in the other frame, stays behind.",
                                counted(size_t(result.reasoning), "scene"));
          Json reasoned;
          if (!arguments->reason.empty()) {
            const memory::Store merged = memory::Store::open_read(arguments->output);
            const memory::ReasonResult reasons = reason(merged, arguments->reason, {}, {}, session.progress(),
                                                        memory::known_identities(merged));
            text += "\n" + reasons.summary();
            reasoned = reasons.report();
          } else if (result.objects > 0 && result.scenes > 0)
            text += fmt::format(
                "\nWhat both have seen may have two names: loci-memory reason -m {} -o OTHER finds out.",
                arguments->output);
          Json json = {{"scenes", result.scenes},
                       {"observations", result.observations},
                       {"objects", result.objects},
                       {"facts", result.facts},
                       {"known_scenes", result.known_scenes},
                       {"reasoning_left", result.reasoning},
                       {"forgotten", result.forgotten},
                       {"corrections_left", result.left_edits},
                       {"renamed", renamed}};
          if (!reasoned.is_null()) json["reason"] = reasoned;
          session.answer(text, json);
        };
      }};
}

Command retain_command() {
  return {
      "retain",
      "Erase old images, then crops, then the data of the reasoning",
      {"loci-memory retain --keep-images 1h -m demo-output/memory.loci -o demo-output/smaller.loci",
       "loci-memory retain --keep-images 1h --keep-crops 2h -m demo-output/memory.loci -o "
       "demo-output/smallest.loci --json"},
      [](ArgumentTable& table) {
        struct Arguments {
          std::string memory, output, images, crops, reasoning;
        };
        auto arguments = std::make_shared<Arguments>();
        table.memory(arguments->memory);
        table.option(
            "--keep-images DURATION", &arguments->images,
            "Keep whole images, depth and clouds for this long: 90s, 12h, 30d or 2y before the last scene");
        table.option("--keep-crops DURATION", &arguments->crops,
                     "Keep crops, masks and large arrays for this long");
        table.option("--keep-reasoning DURATION", &arguments->reasoning,
                     "Keep the inputs of `why` and `reason` for this long");
        table.option("-o,--output MEMORY", &arguments->output, "Erase in a copy; the memory stays as it is");
        return [arguments](Session& session) {
          const memory::RetentionRules rules{age_from(arguments->images), age_from(arguments->crops),
                                             age_from(arguments->reasoning)};
          const memory::RetentionResult result = retain(arguments->memory, rules, arguments->output);
          session.answer(
              fmt::format("{} scenes without images now, {} observations without clouds, {} without "
                          "crops, {} arrays gone, {} scenes without reasons; {} bytes of {} remain.",
                          result.scenes_without_images, result.observations_without_points,
                          result.observations_without_crops, result.arrays, result.scenes_without_reasoning,
                          result.bytes_after, result.bytes_before),
              {{"scenes_without_images", result.scenes_without_images},
               {"observations_without_points", result.observations_without_points},
               {"observations_without_crops", result.observations_without_crops},
               {"arrays", result.arrays},
               {"scenes_without_reasoning", result.scenes_without_reasoning},
               {"bytes_before", result.bytes_before},
               {"bytes_after", result.bytes_after}});
        };
      }};
}

}  // namespace loci::apps
