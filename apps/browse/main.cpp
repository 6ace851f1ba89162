// loci-browse: one window onto one memory, or an image of it.

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

#include "apps/cli/program.h"
#include "gui/window/application.h"
#include "memory/fleet/fleet_replica.h"

namespace {

constexpr const char* kProgram = "loci-browse";
bool is_set(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr && *value != '\0';
}

std::function<void(loci::apps::Session&)> declare(loci::apps::ArgumentTable& table) {
  auto options = std::make_shared<loci::gui::BrowseOptions>();
  auto theme = std::make_shared<std::string>("system");
  options->print = [](const std::string& text) { std::fputs(text.c_str(), stdout); };
  options->has_screen = is_set("DISPLAY") || is_set("WAYLAND_DISPLAY");
  options->has_desktop = is_set("XDG_CURRENT_DESKTOP");
  table.positional("[MEMORY]", &options->file,
                   "The memory to open: FILE.loci, or postgresql://…/DATABASE?robot=NAME");
  table.option("--at TIME", &options->at, "The time to show: 2026-05-01T08:30:00Z, 08:30, \"yesterday 9:00\"",
               {.default_text = "last scene"});
  table.option("--select NAME", &options->select,
               "Select an object (object_12, an alias, \"red\") or a place");
  table.option("--ask QUESTION", &options->ask,
               "Answer a question in the question bar: \"Where is the red cup?\"");
  table.option("--show DOCK", &options->show, "Bring a dock to the front: statistics, log, …");
  table.option("--beside TIME", &options->beside,
               "Show the map of another time or another memory (FILE.loci) beside the map, with the "
               "differences marked");
  table.option("--room FILE", &options->room,
               "Draw the room as a depth camera saw it: the room.ply that loci-map fuse or interpret wrote");
  table.option("--run ACTION", &options->run,
               "Run an action of the menus first, by name: \"Depth image\"; may be repeated");
  table.option("--theme THEME", theme.get(), "Colours", {.choices = {"system", "light", "dark"}});
  table.begin_group("Screenshot");
  table.option("--screenshot FILE", &options->screenshot,
               "Write an image of the window as PNG and exit; works without a screen", {.replaces = true});
  table.option("--view VIEW", &options->view, "What the image shows", {.choices = {"window", "map"}});
  table.option("--hide LAYER", &options->hide, "Leave out a layer of the map; may be repeated",
               {.choices = {"map", "room", "objects", "labels", "cloud", "camera", "trace", "cameras"}});
  table.option("--size SIZE", &options->size, "Size of the image in pixels");
  table.option("--measure", &options->measure_s, "Measure the window for so many seconds and exit",
               {.hidden = true});
  return [options, theme](loci::apps::Session& session) {
    using loci::gui::ThemeChoice;
    options->theme = *theme == "light"  ? ThemeChoice::light
                     : *theme == "dark" ? ThemeChoice::dark
                                        : ThemeChoice::system;
    if (loci::memory::is_fleet_url(options->file))
      options->file = loci::memory::FleetReplica(options->file, loci::apps::cache_folder() / "fleet")
                          .update(session.progress());
    session.set_exit_code(loci::gui::run_browser(*options, kProgram));
  };
}

}  // namespace

int main(int argc, char** argv) {
  loci::apps::Program program(kProgram, "Show an object memory in a window, or write an image of it");
  program.add({"",
               "Show an object memory in a window, or write an image of it",
               {"loci-browse demo-output/memory.loci",
                "loci-browse demo-output/memory.loci --screenshot browser.png --select object_1"},
               declare});
  return program.run(argc, argv);
}
