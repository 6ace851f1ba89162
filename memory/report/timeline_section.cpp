#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/html.h"
#include "memory/report/report_data.h"

namespace loci::memory {
namespace {

constexpr double kNames = 130, kWidth = 900, kLane = 22;

/// A lane per object: bars while it was seen at one spot, a line in between, an open end when it is gone.
class Lanes {
 public:
  explicit Lanes(const ReportData& data)
      : data_(data), first_(data.scenes.front().time), last_(data.scenes.back().time) {}

  std::string svg() const {
    std::string shapes;
    double y = kLane;
    for (const ObjectHistory& history : data_.histories) {
      if (history.stays.empty() || history.stays.back().scenes.back().time < first_) continue;
      shapes += lane(history, y);
      y += kLane;
    }
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" "
        "font-family=\"system-ui, sans-serif\" font-size=\"12\" fill=\"currentColor\" role=\"img\" "
        "aria-label=\"where each object was seen when\">\n<text x=\"{2:.0f}\" y=\"12\">{3}</text>"
        "<text x=\"{4:.0f}\" y=\"12\" text-anchor=\"end\">{5}</text>\n{6}{7}</svg>\n",
        kNames + kWidth + 10, y + 4, kNames, html_escape(data_.times.text(first_)), kNames + kWidth,
        html_escape(data_.times.text(last_)), scenes(y), shapes);
  }

 private:
  double x(TimeNs time) const {
    if (last_ == first_) return kNames;
    const double part = static_cast<double>(time - first_) / static_cast<double>(last_ - first_);
    return kNames + kWidth * std::clamp(part, 0.0, 1.0);
  }

  /// When somebody looked at all.
  std::string scenes(double bottom) const {
    std::string path;
    for (const SceneRow& scene : data_.scenes)
      path += fmt::format("M{:.1f} 16V{:.0f}", x(scene.time), bottom - kLane / 2);
    return "<path d=\"" + path + "\" stroke=\"currentColor\" stroke-opacity=\".12\"/>\n";
  }

  std::string lane(const ObjectHistory& history, double y) const {
    const std::string css = object_css(history.now.object.id);
    const double from = x(history.stays.front().scenes.front().time);
    const bool gone = history.now.status == "gone";
    const double to = gone ? x(history.stays.back().scenes.back().time) : kNames + kWidth;
    std::string shapes = fmt::format(
        "<text x=\"0\" y=\"{:.0f}\">{}</text><path d=\"M{:.1f} {:.0f}H{:.1f}\" stroke=\"{}\" "
        "stroke-opacity=\".5\" stroke-dasharray=\"2 3\"/>\n",
        y + 8, html_escape(history.now.object.name), from, y + 4, to, css);
    for (const Stay& stay : history.stays) {
      const double begin = x(stay.scenes.front().time), end = x(stay.scenes.back().time);
      const std::string place = stay.place ? stay.place->name : "no place";
      shapes += fmt::format(
          "<rect x=\"{:.1f}\" y=\"{:.0f}\" width=\"{:.1f}\" height=\"8\" rx=\"3\" "
          "fill=\"{}\"><title>{}</title></rect>\n",
          begin - 3, y, end - begin + 6, css,
          html_escape(fmt::format("{} on {}, {}", history.now.object.name, place,
                                  data_.times.span_text(stay.scenes.front().time, stay.scenes.back().time))));
    }
    return shapes;
  }

  const ReportData& data_;
  TimeNs first_, last_;
};

}  // namespace

std::string timeline_section(const ReportData& data) {
  if (data.scenes.empty())
    return html_section("timeline", "What happened", "<p class=\"faint\">No scene has been seen yet.</p>");
  std::vector<std::vector<std::string>> rows;
  const TimelineQuestion question{.from = data.scenes.front().time};
  for (const TimelineEntry& entry : ask(data.store, question).entries) {
    std::string happened;
    for (const Change& change : entry.changes)
      happened += (happened.empty() ? "" : "; ") + change_text(change);
    rows.push_back({data.times.text(entry.scene.scene.time), fmt::format("{}", entry.seen.size()), happened});
  }
  return html_section("timeline", "What happened",
                      data.scenes_left_out() + Lanes(data).svg() +
                          html_table({"time", "objects seen", "what changed"}, rows));
}

}  // namespace loci::memory
