// loci-browse: one window onto one memory, or an image of it.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>

#include "apps/cli/program.h"
#include "gui/application.h"

namespace {

constexpr const char* kProgram = "loci-browse";
constexpr const char* kExamples =
    "Examples:\n"
    "  loci-browse demo-output/memory.loci\n"
    "  loci-browse demo-output/memory.loci --screenshot browser.png --select object_1";

bool is_set(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr && *value != '\0';
}

void declare(CLI::App& app, loci::gui::BrowseOptions& options) {
  static const std::map<std::string, loci::gui::ThemeChoice> kThemes = {
      {"system", loci::gui::ThemeChoice::system},
      {"light", loci::gui::ThemeChoice::light},
      {"dark", loci::gui::ThemeChoice::dark}};
  app.footer(kExamples);
  app.add_option("FILE", options.file, "The memory to open (*.loci)");
  app.add_option("--screenshot", options.screenshot,
                 "Write an image of the window to this PNG file and exit; needs no screen");
  app.add_option("--at", options.at,
                 "The time to show: 2026-05-01T08:30:00Z, 08:30, \"yesterday 9:00\" [last scene]");
  app.add_option("--select", options.select,
                 "What to choose: an object (object_12, an alias, \"red\") or a place");
  app.add_option("--ask", options.ask, "A question to answer in the question bar: \"Where is the red cup?\"");
  app.add_option("--show", options.show, "The dock to bring to the front: statistics, log, ...");
  app.add_option(
      "--beside", options.beside,
      "Another time, or another memory: its map stands beside the map, and what differs is marked");
  app.add_option("--run", options.run, "Actions of the menus to run first, by name: \"Depth image\"");
  app.add_option("--theme", options.theme, "Colours: system, light, dark [system]")
      ->transform(CLI::CheckedTransformer(kThemes))
      ->option_text("TEXT");
  app.add_option("--view", options.view, "What the image shows: the whole window, or the map alone")
      ->capture_default_str();
  app.add_option(
      "--hide", options.hide,
      "Layers of the map that the image leaves out: map, objects, labels, cloud, camera, trace, cameras");
  app.add_option("--measure", options.measure_s, "Measure the window for so many seconds and exit")
      ->group("");
  app.add_option("--size", options.size, "Size of the image in pixels")->capture_default_str();
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Looks through the memory of a room.", kProgram);
  loci::gui::BrowseOptions options;
  options.say = [](const std::string& text) { std::fputs(text.c_str(), stdout); };
  options.has_screen = is_set("DISPLAY") || is_set("WAYLAND_DISPLAY");
  options.has_desktop = is_set("XDG_CURRENT_DESKTOP");
  declare(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return loci::apps::run_guarded(kProgram, [&] { return loci::gui::run_browser(options, kProgram); });
}
