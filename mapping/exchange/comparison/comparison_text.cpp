#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>

#include "mapping/base/text/json.h"
#include "mapping/exchange/comparison/compare.h"

namespace loci::mapping {
namespace {

constexpr std::array<const char*, 5> kKinds = {"support", "wall", "opening", "front", "handle"};

std::string number(const std::optional<double>& value, const char* format) {
  return value ? fmt::format(fmt::runtime(format), *value) : std::string("-");
}

std::string or_dash(const std::string& text) {
  return text.empty() ? "-" : text;
}

/// One column of a kind's table.
struct Column {
  const char* heading;
  size_t width;
  std::function<std::string(const ComparedElement&)> text;
};

std::string edges_text(const ComparedElement& element) {
  if (!element.overlap) return "-";
  return fmt::format("{:+.3f} {:+.3f} {:+.3f} {:+.3f}", element.edge_errors[0], element.edge_errors[1],
                     element.edge_errors[2], element.edge_errors[3]);
}

template <class Member>
Column column(const char* heading, size_t width, const char* format, Member member) {
  return {heading, width, [=](const ComparedElement& element) { return number(element.*member, format); }};
}

template <class Text>
Column joint_column(const char* heading, size_t width, Text text) {
  return {heading, width, [=](const ComparedElement& element) {
            return element.joint ? text(*element.joint) : std::string("-");
          }};
}

std::vector<Column> columns_of(const std::string& kind) {
  using T = ComparedElement;
  if (kind == "wall")
    return {column("offset m", 9, "{:+.3f}", &T::offset_error),
            column("angle deg", 10, "{:.2f}", &T::angle_error_deg)};
  if (kind == "handle")
    return {column("centre m", 9, "{:.3f}", &T::centre_error),
            column("bar deg", 8, "{:.1f}", &T::angle_error_deg)};
  if (kind == "front")
    return {
        column("IoU", 6, "{:.2f}", &T::overlap),
        column("offset m", 9, "{:+.3f}", &T::offset_error),
        joint_column("true joint", 11, [](const ComparedJoint& j) { return j.truth_type; }),
        joint_column("joint", 10, [](const ComparedJoint& j) { return or_dash(j.map_type); }),
        joint_column("evidence", 12, [](const ComparedJoint& j) { return or_dash(j.evidence); }),
        joint_column("axis deg", 9,
                     [](const ComparedJoint& j) { return number(j.axis_error_deg, "{:.2f}"); }),
        joint_column("hinge m", 8, [](const ComparedJoint& j) { return number(j.hinge_error, "{:.3f}"); })};
  if (kind == "opening") return {column("IoU", 6, "{:.2f}", &T::overlap), {"edges m", 29, edges_text}};
  return {column("height m", 9, "{:+.3f}", &T::height_error),
          column("IoU", 6, "{:.2f}", &T::overlap),
          {"edges m", 29, edges_text}};
}

std::string table_text(const std::string& kind, const std::vector<const ComparedElement*>& elements) {
  const std::vector<Column> columns = columns_of(kind);
  std::string text = fmt::format("{:<9}{:<26} {:<34}", kind, "map", "truth");
  for (const Column& one : columns) text += fmt::format(" {:>{}}", one.heading, one.width);
  text += "\n";
  for (const ComparedElement* element : elements) {
    text += fmt::format("{:<9}{:<26} {:<34}", element->verdict, or_dash(element->map_name),
                        or_dash(element->truth_name));
    for (const Column& one : columns) text += fmt::format(" {:>{}}", one.text(*element), one.width);
    text += "\n";
  }
  return text + "\n";
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

Json statistics(const std::vector<double>& values) {
  if (values.empty()) return nullptr;
  std::vector<double> sorted = values;
  std::ranges::sort(sorted);
  return {{"mean", mean_of(values)},
          {"median", sorted[sorted.size() / 2]},
          {"min", sorted.front()},
          {"max", sorted.back()}};
}

std::string statistics_text(const char* what, const std::vector<double>& values, const char* format) {
  if (values.empty()) return {};
  const auto [least, most] = std::ranges::minmax(values);
  return fmt::format("; {} {} mean ({} to {})", what, number(mean_of(values), format), number(least, format),
                     number(most, format));
}

std::optional<double> fraction_of(size_t part, size_t all) {
  return all == 0 ? std::nullopt : std::optional(static_cast<double>(part) / static_cast<double>(all));
}

Json json_of(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json json_of(const ComparedJoint& joint) {
  Json json = {{"map_type", joint.map_type.empty() ? Json(nullptr) : Json(joint.map_type)},
               {"truth_type", joint.truth_type},
               {"right", joint.right()},
               {"other_way", joint.other_way}};
  if (!joint.evidence.empty()) json["evidence"] = joint.evidence;
  if (joint.axis_error_deg) json["axis_error_deg"] = *joint.axis_error_deg;
  if (joint.hinge_error) json["hinge_error_m"] = *joint.hinge_error;
  return json;
}

Json json_of(const ComparedElement& element) {
  Json json = {{"kind", element.kind}, {"verdict", element.verdict}};
  json["map"] = element.map_name.empty() ? Json(nullptr) : Json(element.map_name);
  json["truth"] = element.truth_name.empty() ? Json(nullptr) : Json(element.truth_name);
  const auto set = [&](const char* key, const std::optional<double>& value) {
    if (value) json[key] = *value;
  };
  set("height_error_m", element.height_error);
  set("iou", element.overlap);
  set("offset_error_m", element.offset_error);
  set("angle_error_deg", element.angle_error_deg);
  set("centre_error_m", element.centre_error);
  if ((element.kind == "support" || element.kind == "opening") && element.overlap)
    json["edge_errors_m"] = element.edge_errors;
  if (element.joint) json["joint"] = json_of(*element.joint);
  return json;
}

}  // namespace

std::optional<double> Comparison::Counts::precision() const {
  return fraction_of(matched + minor, matched + minor + extra);
}

std::optional<double> Comparison::Counts::recall() const {
  return fraction_of(matched, matched + missed);
}

Comparison::Counts Comparison::counts(const std::string& kind) const {
  Counts counts;
  for (const ComparedElement& element : elements) {
    if (element.kind != kind) continue;
    counts.matched += element.verdict == "matched";
    counts.missed += element.verdict == "missed";
    counts.extra += element.verdict == "extra";
    counts.minor += element.verdict == "minor";
    counts.not_observable += element.verdict == "not observable";
  }
  return counts;
}

double Comparison::Joints::rate() const {
  return asked == 0 ? 1 : static_cast<double>(right) / static_cast<double>(asked);
}

Comparison::Joints Comparison::joints() const {
  Joints joints;
  for (const ComparedElement& element : elements) {
    if (element.verdict != "matched" || !element.joint) continue;
    ++joints.asked;
    joints.right += element.joint->right();
    joints.other_way += element.joint->other_way;
  }
  return joints;
}

std::vector<double> Comparison::errors(const std::string& kind,
                                       std::optional<double> ComparedElement::*figure) const {
  std::vector<double> values;
  for (const ComparedElement& element : elements)
    if (element.kind == kind && element.verdict == "matched" && element.*figure)
      values.push_back(std::abs(*(element.*figure)));
  return values;
}

std::vector<double> Comparison::edge_errors(const std::string& kind) const {
  std::vector<double> values;
  for (const ComparedElement& element : elements)
    if (element.kind == kind && element.verdict == "matched")
      for (const double error : element.edge_errors) values.push_back(std::abs(error));
  return values;
}

std::vector<double> Comparison::joint_errors(std::optional<double> ComparedJoint::*figure) const {
  std::vector<double> values;
  for (const ComparedElement& element : elements)
    if (element.verdict == "matched" && element.joint && (*element.joint).*figure)
      values.push_back(*((*element.joint).*figure));
  return values;
}

std::string Comparison::text() const {
  std::string text;
  for (const char* kind : {"support", "wall", "opening", "floor", "front", "handle"}) {
    std::vector<const ComparedElement*> of_kind;
    for (const ComparedElement& element : elements)
      if (element.kind == kind) of_kind.push_back(&element);
    if (!of_kind.empty()) text += table_text(kind, of_kind);
  }
  for (const char* kind : kKinds) {
    const Counts c = counts(kind);
    text += fmt::format("{}s: {} matched, {} missed, {} extra, {} minor; precision {}, recall {}", kind,
                        c.matched, c.missed, c.extra, c.minor, number(c.precision(), "{:.2f}"),
                        number(c.recall(), "{:.2f}"));
    if (c.not_observable > 0) text += fmt::format("; {} not observable", c.not_observable);
    text += statistics_text("IoU", errors(kind, &ComparedElement::overlap), "{:.2f}");
    if (std::string(kind) == "opening") text += statistics_text("edges", edge_errors(kind), "{:.3f} m");
    text += statistics_text("centre", errors(kind, &ComparedElement::centre_error), "{:.3f} m");
    text += "\n";
  }
  const Joints moving = joints();
  text += fmt::format("joints: {} of {} found have the right type", moving.right, moving.asked);
  if (moving.other_way > 0) text += fmt::format(", {} of these open the other way", moving.other_way);
  text += statistics_text("axis", joint_errors(&ComparedJoint::axis_error_deg), "{:.2f} deg");
  text += statistics_text("hinge", joint_errors(&ComparedJoint::hinge_error), "{:.3f} m");
  return text + "\n";
}

Json Comparison::report() const {
  Json list = Json::array();
  for (const ComparedElement& element : elements) list.push_back(json_of(element));
  Json json = {{"map_source", map_source}, {"truth_source", truth_source}, {"elements", list}};
  for (const char* kind : kKinds) {
    const Counts c = counts(kind);
    Json& sum = json[std::string(kind) + "s"] = {{"matched", c.matched},
                                                 {"missed", c.missed},
                                                 {"extra", c.extra},
                                                 {"minor", c.minor},
                                                 {"precision", json_of(c.precision())},
                                                 {"recall", json_of(c.recall())}};
    const auto add = [&](const char* key, std::optional<double> ComparedElement::*figure) {
      if (Json value = statistics(errors(kind, figure)); !value.is_null()) sum[key] = std::move(value);
    };
    add("height_error_m", &ComparedElement::height_error);
    add("iou", &ComparedElement::overlap);
    add("offset_error_m", &ComparedElement::offset_error);
    add("angle_error_deg", &ComparedElement::angle_error_deg);
    add("centre_error_m", &ComparedElement::centre_error);
    if (std::string(kind) == "opening")
      if (Json edges = statistics(edge_errors(kind)); !edges.is_null())
        sum["edge_error_m"] = std::move(edges);
  }
  const Joints moving = joints();
  json["joints"] = {{"asked", moving.asked},
                    {"right", moving.right},
                    {"rate", moving.rate()},
                    {"other_way", moving.other_way},
                    {"axis_error_deg", statistics(joint_errors(&ComparedJoint::axis_error_deg))},
                    {"hinge_error_m", statistics(joint_errors(&ComparedJoint::hinge_error))}};
  return json;
}

}  // namespace loci::mapping
