#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/html.h"
#include "memory/report/memory_statistics.h"
#include "memory/report/report_data.h"

namespace loci::memory {
namespace {

std::string bars(const Chart& chart) {
  double most = 0;
  for (const auto& [name, value] : chart.bars) most = std::max(most, value);
  std::string rows;
  for (const auto& [name, value] : chart.bars)
    rows += fmt::format(
        "<tr><td>{}</td><td class=\"number\">{}</td><td><div class=\"bar\" "
        "style=\"width:{:.0f}%\"></div></td></tr>\n",
        html_escape(name), value, most > 0 ? 100 * value / most : 0);
  return fmt::format(
      "<figure><figcaption>{} <span class=\"faint\">({})</span></figcaption><table "
      "class=\"bars\">{}</table></figure>\n",
      html_escape(chart.title), html_escape(chart.unit), rows);
}

}  // namespace

std::string statistics_section(const ReportData& data, Progress& progress) {
  std::string body;
  for (const Chart& chart : memory_statistics(data.store, progress))
    if (!chart.bars.empty()) body += bars(chart);
  return html_section("statistics", "Statistics", "<div class=\"cards\">\n" + body + "</div>\n");
}

}  // namespace loci::memory
