// Memories of many robots in PostgreSQL: push, grant, unify.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/json.h"
#include "memory/fleet/fleet_roles.h"
#include "memory/fleet/push.h"
#include "memory/fleet/unify.h"

namespace loci::apps {
namespace {

constexpr const char* kUrlHelp = "postgresql://USER@HOST:PORT/DATABASE, as libpq has it";

struct PushArguments {
  std::string memory, url;
  memory::PushOptions options{.name = {.home = "home"}};
  bool follow = false;
  double every_s = 0.5;
};

/// Reports what a push did.
void answer_push(Session& session, const PushArguments& arguments, const memory::PushResult& result,
                 double seconds) {
  Json json = result.report();
  json["home"] = arguments.options.name.home;
  json["robot"] = arguments.options.name.robot;
  json["seconds"] = seconds;
  session.answer(fmt::format("{}: {}", arguments.options.name.robot, result.summary()), json);
}

void push(const PushArguments& arguments, Session& session) {
  memory::MemoryPush push(arguments.memory, memory::parse_fleet_url(arguments.url), arguments.options);
  for (bool first = true; first || (arguments.follow && !interrupted()); first = false) {
    if (!first) std::this_thread::sleep_for(std::chrono::duration<double>(arguments.every_s));
    const Stopwatch stopwatch;
    const memory::PushResult result = push.run(session.progress());
    if (first || result.transactions > 0) answer_push(session, arguments, result, stopwatch.seconds());
    std::fflush(stdout);
  }
}

}  // namespace

Command push_command() {
  return {
      .name = "push",
      .description = "Replicate a memory into PostgreSQL, where the memories of many robots are",
      .examples = {"loci-memory push postgresql:///loci --robot robot_1 -m demo-output/memory.loci",
                   "loci-memory push postgresql:///loci --robot robot_1 -m demo-output/memory.loci --json"},
      .declare = [](ArgumentTable& table) {
        auto arguments = std::make_shared<PushArguments>();
        table.memory(arguments->memory);
        table.positional("URL", &arguments->url, kUrlHelp);
        table.option("--robot NAME", &arguments->options.name.robot, "Name of the robot", {.required = true});
        table.option("--home NAME", &arguments->options.name.home,
                     "Name of the home, which several robots may share");
        table.flag(
            "--replace", arguments->options.replace,
            "Replace all that the robot has in the database: another memory, or rows that somebody changed");
        table.flag("--follow", arguments->follow, "Go on pushing while the memory is written, until Ctrl-C");
        table.option("--every SECONDS", &arguments->every_s, "Time between two pushes",
                     {.unit = "s", .min = 0.05, .needs = {"--follow"}});
        return [arguments](Session& session) { push(*arguments, session); };
      }};
}

Command grant_command() {
  return {
      .name = "grant",
      .description = "Let a role of PostgreSQL push the memory of a robot, or read those of a home",
      .examples = {"loci-memory grant postgresql:///loci postgres --robot robot_1",
                   "loci-memory grant postgresql:///loci postgres --reader --json"},
      .declare = [](ArgumentTable& table) {
        struct Arguments {
          std::string url, robot;
          memory::FleetRole role{.home = "home"};
          bool reader = false, revoke = false;
        };
        auto arguments = std::make_shared<Arguments>();
        table.positional("URL", &arguments->url, std::string(kUrlHelp) + "; its user owns the schema loci");
        table.positional("ROLE", &arguments->role.role, "A role that the server has (CREATE ROLE)");
        table.option("--robot NAME", &arguments->robot,
                     "May read, add and remove the rows of this robot alone");
        table.flag("--reader", arguments->reader, "May read the memories of the home, and write nothing",
                   {.excludes = {"--robot"}});
        table.option("--home NAME", &arguments->role.home, "Name of the home");
        table.flag("--revoke", arguments->revoke, "Take these rights back");
        return [arguments](Session& session) {
          if (arguments->robot.empty() && !arguments->reader)
            throw UsageError("--robot or --reader is required");
          if (!arguments->reader) arguments->role.robot = arguments->robot;
          const memory::FleetRole& role = arguments->role;
          const memory::FleetUrl url = memory::parse_fleet_url(arguments->url);
          (arguments->revoke ? memory::revoke_role : memory::grant_role)(url, role);
          const std::vector<std::string> homes =
              role.robot ? memory::homes_of(url, *role.robot) : std::vector<std::string>();
          if (!homes.empty() && std::ranges::count(homes, role.home) == 0)
            session.warnings().add(fmt::format("home '{}' has no memory of robot '{}'; with --home: '{}'",
                                               role.home, *role.robot, fmt::join(homes, "', '")));
          const std::string what =
              arguments->reader ? fmt::format("read the memories of home '{}'", role.home)
                                : fmt::format("push robot '{}' of home '{}'", arguments->robot, role.home);
          session.answer(
              fmt::format("Role '{}' may {}{}.", role.role, arguments->revoke ? "no longer " : "", what),
              {{"role", role.role},
               {"home", role.home},
               {"robot", arguments->reader ? Json() : Json(arguments->robot)},
               {"granted", !arguments->revoke}});
        };
      }};
}

Command unify_command() {
  return {.name = "unify",
          .description = "Join the memories of a home's robots: objects that several have seen become one",
          .examples = {"loci-memory unify postgresql:///loci", "loci-memory unify postgresql:///loci --json"},
          .declare = [](ArgumentTable& table) {
            struct Arguments {
              std::string url;
              memory::RobotName name{.home = "home", .robot = "unified"};
            };
            auto arguments = std::make_shared<Arguments>();
            table.positional("URL", &arguments->url, kUrlHelp);
            table.option("--home NAME", &arguments->name.home, "Name of the home");
            table.option("--as NAME", &arguments->name.robot,
                         "Name of the robot that has the unified memory");
            return [arguments](Session& session) {
              const memory::UnifyResult result =
                  memory::unify(memory::parse_fleet_url(arguments->url), arguments->name,
                                cache_folder() / "fleet", session.progress());
              session.answer(result.summary(), result.report());
            };
          }};
}

}  // namespace loci::apps
