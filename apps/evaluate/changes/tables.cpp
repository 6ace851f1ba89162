#include <fmt/format.h>

#include "apps/evaluate/changes/comparison.h"
#include "mapping/base/text/json.h"

namespace loci::apps::changes {
namespace {

std::string share(size_t right, size_t total) {
  return total == 0 ? std::string("-") : fmt::format("{} of {}", right, total);
}

/// One line of a figure, one column for each method.
template <class Figure>
std::string line(const char* name, const std::vector<Comparison>& methods, Figure figure) {
  std::string out = fmt::format("{:<24}", name);
  for (const Comparison& method : methods) out += fmt::format(" {:>14}", figure(method));
  return out + "\n";
}

std::string figures(const std::vector<Comparison>& methods) {
  std::string out = line("right, by kind", methods, [](const Comparison& c) { return c.method; });
  for (const char* kind : kTrueKinds) {
    if (std::string(kind) == "uncertain" || methods.front().count(kind) == 0) continue;
    out +=
        line(kind, methods, [&](const Comparison& c) { return share(c.count_right(kind), c.count(kind)); });
  }
  out +=
      line("certain transitions", methods, [](const Comparison& c) { return share(c.right(), c.certain()); });
  out += line("identity F1", methods,
              [](const Comparison& c) { return fmt::format("{:.3f}", c.identity_f1()); });
  out += line("identity switches", methods, [](const Comparison& c) { return share(c.switches, c.pairs); });
  out += line("false disappearances", methods, [](const Comparison& c) { return c.false_gone; });
  out += line("recognised on return", methods,
              [](const Comparison& c) { return share(c.recognised, c.returned); });
  out += line("association, Brier score", methods, [](const Comparison& c) {
    return c.association.empty() ? std::string("-") : fmt::format("{:.3f}", brier_score(c.association));
  });
  out += line("calibration error", methods, [](const Comparison& c) {
    return c.association.empty() ? std::string("-") : fmt::format("{:.3f}", calibration_error(c.association));
  });
  out += line("objects that are no object", methods, [](const Comparison& c) { return c.phantoms; });
  return out;
}

std::string what_was_said(const Comparison& comparison) {
  std::string out = fmt::format("{:<17}", "truth \\ said");
  for (const char* said : kSaidKinds) out += fmt::format(" {:>15}", said);
  out += "\n";
  for (const char* kind : kTrueKinds) {
    if (comparison.count(kind) == 0) continue;
    out += fmt::format("{:<17}", kind);
    for (const char* said : kSaidKinds) out += fmt::format(" {:>15}", comparison.count(kind, said));
    out += "\n";
  }
  return out;
}

std::string one_by_one(const Comparison& comparison) {
  std::string out;
  const auto name = [](memory::Id id) { return id == 0 ? std::string("-") : memory::object_name(id); };
  for (const JudgedTransition& t : comparison.transitions)
    out += fmt::format("{:>4} -> {:<4} {:<16} {:<16} {:<16} {} -> {}{}\n", t.truth.from_frame,
                       t.truth.to_frame, t.truth.object, t.truth.kind, t.said, name(t.from_object),
                       name(t.to_object), t.right() || !t.counts() ? "" : "   WRONG");
  return out;
}

Json list_of(const Comparison& comparison) {
  Json list = Json::array();
  for (const JudgedTransition& t : comparison.transitions)
    list.push_back({{"from_frame", t.truth.from_frame},
                    {"to_frame", t.truth.to_frame},
                    {"object", t.truth.object},
                    {"truth", t.truth.kind},
                    {"said", t.said},
                    {"right", t.right()},
                    {"memory_from", t.from_object == 0 ? Json() : Json(memory::object_name(t.from_object))},
                    {"memory_to", t.to_object == 0 ? Json() : Json(memory::object_name(t.to_object))}});
  return list;
}

Json association_of(const Stated& stated) {
  Json bins = Json::array();
  for (const ReliabilityBin& bin : reliability_bins(stated))
    bins.push_back({{"count", bin.count}, {"stated", bin.stated}, {"right", bin.right}});
  return {{"stated", stated.size()},
          {"calibration_error", calibration_error(stated)},
          {"brier", brier_score(stated)},
          {"bins", bins}};
}

Json figures_of(const Comparison& comparison) {
  Json table = Json::object(), kinds = Json::object();
  for (const char* kind : kTrueKinds) {
    for (const char* said : kSaidKinds) table[kind][said] = comparison.count(kind, said);
    if (std::string(kind) != "uncertain")
      kinds[kind] = {{"right", comparison.count_right(kind)}, {"total", comparison.count(kind)}};
  }
  return {{"table", table},
          {"kinds", kinds},
          {"certain", comparison.certain()},
          {"right", comparison.right()},
          {"visible", comparison.visible},
          {"found", comparison.found},
          {"identity_f1", comparison.identity_f1()},
          {"identity_switches", comparison.switches},
          {"identity_pairs", comparison.pairs},
          {"false_disappearances", comparison.false_gone},
          {"returned", comparison.returned},
          {"recognised", comparison.recognised},
          {"phantoms", comparison.phantoms},
          {"association", association_of(comparison.association)},
          {"arbiter",
           {{"observations", comparison.arbiter.observations},
            {"settled", comparison.arbiter.settled},
            {"as_decided", comparison.arbiter.as_decided}}}};
}

}  // namespace

std::string text(const std::vector<Comparison>& methods, bool verbose) {
  const Comparison& first = methods.front();
  std::string out = figures(methods);
  out += fmt::format("found: {} of {} visible objects\n", first.found, first.visible);
  const memory::belief::ArbiterCount& arbiter = first.arbiter;
  if (arbiter.observations > 0)
    out += fmt::format("simple trackers settle {} of {} observations, {} as was decided\n", arbiter.settled,
                       arbiter.observations, arbiter.as_decided);
  out += "\n";
  out += what_was_said(first);
  return verbose ? out + one_by_one(first) : out;
}

Json to_json(const std::vector<Comparison>& methods) {
  Json json = figures_of(methods.front());
  json["transitions"] = list_of(methods.front());
  for (const Comparison& method : methods) {
    json["methods"][method.method] = figures_of(method);
    json["statements"][method.method] = method.association;
  }
  return json;
}

}  // namespace loci::apps::changes
