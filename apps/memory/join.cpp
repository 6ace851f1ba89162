// Memories are joined, and let go of images that are old.

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"
#include "mapping/base/json.h"
#include "mapping/base/math.h"
#include "memory/reasoning/reason.h"
#include "memory/store/memory_file.h"
#include "memory/store/merge.h"
#include "memory/store/retention.h"

namespace loci::apps {
namespace {

/// "x,y,z,yaw_deg".
memory::FrameChange frame_from(const std::string& text) {
  std::vector<double> values;
  const char *at = text.data(), *const end = text.data() + text.size();
  while (at < end) {
    double value = 0;
    const auto read = std::from_chars(at, end, value);
    if (read.ec != std::errc() || !std::isfinite(value) || (read.ptr < end && *read.ptr != ',')) break;
    values.push_back(value);
    at = read.ptr + 1;
  }
  if (values.size() != 4 || at <= end)
    throw Error("'" + text + "' is no transform", {}, "write --transform x,y,z,yaw_deg, for example 0,0,0,0");
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
  throw Error("'" + text + "' is no age", {}, "write 90s, 12h, 30d or 2y");
}

}  // namespace

Command merge_command() {
  return {
      "merge",
      "Joins two memories of one home, of several robots or runs, without loss",
      {"loci-memory merge demo-output/memory.loci demo-output/memory.loci -o demo-output/merged.loci",
       "loci-memory merge demo-output/memory.loci demo-output/memory.loci --transform 0,0,0,0 -o "
       "demo-output/merged_same_frame.loci --json"},
      [](ArgumentTable& table) {
        struct Arguments {
          std::string first, second, output, transform, reason;
        };
        auto arguments = std::make_shared<Arguments>();
        table.positional("MEMORY", &arguments->first, "The memory whose map frame is that of the result");
        table.positional("OTHER", &arguments->second, "The memory that is added");
        table.option("-o,--output", &arguments->output, "The new memory", {.required = true});
        table.option(
            "--transform", &arguments->transform,
            "Where the second map frame lies in the first: x,y,z,yaw_deg; 0,0,0,0 = it is the same one");
        table.option("--reason", &arguments->reason,
                     "Then reason over both together, into this new memory: what both have seen becomes one");
        return [arguments](Session& session) {
          std::optional<memory::FrameChange> frame;
          if (!arguments->transform.empty()) frame = frame_from(arguments->transform);
          const memory::MergeResult result =
              merge(arguments->first, arguments->second, arguments->output, frame, session.progress());
          std::string text = fmt::format(
              "{} scenes with {} observations of {} objects and {} facts came in; {} scenes were known.",
              result.scenes, result.observations, result.objects, result.facts, result.known_scenes);
          Json renamed = Json::object();
          for (const auto& [old, name] : result.renamed) {
            text += fmt::format("\n{} of the second memory lies elsewhere: it is called {} now.", old, name);
            renamed[old] = name;
          }
          if (result.reasoning > 0)
            text += fmt::format("\nThe reasoning of {} scenes, which is in the other frame, stays behind.",
                                result.reasoning);
          Json reasoned;
          if (!arguments->reason.empty()) {
            const memory::ReasonResult reasons = reason(memory::Store::open_read(arguments->output),
                                                        arguments->reason, {}, {}, session.progress());
            text += "\n" + reasons.summary();
            reasoned = reasons.report();
          } else if (result.scenes > 0)
            text += fmt::format(
                "\nWhat both have seen has two names: loci-memory reason -m {} -o OTHER finds out.",
                arguments->output);
          Json json = {{"scenes", result.scenes},
                       {"observations", result.observations},
                       {"objects", result.objects},
                       {"facts", result.facts},
                       {"known_scenes", result.known_scenes},
                       {"reasoning_left", result.reasoning},
                       {"renamed", renamed}};
          if (!reasoned.is_null()) json["reason"] = reasoned;
          session.answer(text, json);
        };
      }};
}

Command retain_command() {
  return {"retain",
          "Lets images that are old go, then crops, and reasons: numbers stay",
          {"loci-memory retain --images 1h -m demo-output/memory.loci -o demo-output/smaller.loci",
           "loci-memory retain --images 1h --crops 2h -m demo-output/memory.loci -o "
           "demo-output/smaller.loci --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              std::string memory, output, images, crops, reasoning;
            };
            auto arguments = std::make_shared<Arguments>();
            table.memory(arguments->memory);
            table.option(
                "--images", &arguments->images,
                "Whole images, depth and clouds are kept so long (90s, 12h, 30d, 2y before the last scene)");
            table.option("--crops", &arguments->crops, "Crops, masks and large arrays are kept so long");
            table.option("--reasoning", &arguments->reasoning,
                         "What `why` and `reason` rest on is kept so long");
            table.option("-o,--output", &arguments->output, "Do so in a copy and leave the memory as it is");
            return [arguments](Session& session) {
              const memory::RetentionRules rules{age_from(arguments->images), age_from(arguments->crops),
                                                 age_from(arguments->reasoning)};
              if (!arguments->output.empty()) memory::copy_memory(arguments->memory, arguments->output);
              const memory::RetentionResult result =
                  retain(arguments->output.empty() ? arguments->memory : arguments->output, rules);
              session.answer(
                  fmt::format("{} scenes without images now, {} observations without clouds, {} without "
                              "crops, {} arrays gone, {} scenes without reasons; {} bytes of {} remain.",
                              result.scenes_without_images, result.observations_without_points,
                              result.observations_without_crops, result.arrays,
                              result.scenes_without_reasoning, result.bytes_after, result.bytes_before),
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
