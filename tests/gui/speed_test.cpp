// How fast the window is on a large map with many objects. It prints figures; what it asserts is that all of
// it was drawn. Figures of a quiet machine stand in docs/performance.md.

#include <gtest/gtest.h>

#include <cstdio>

#include "gui/data/open_memory.h"
#include "gui/scene3d/object_actors.h"
#include "gui/window/benchmark.h"
#include "gui/window/main_window.h"
#include "mapping/base/files.h"
#include "tests/gui/large_memory.h"

namespace loci::gui {
namespace {

const std::filesystem::path kApartment = std::filesystem::path(LOCI_SHARED_DIR) / "data/iai_apartment";

TEST(WindowSpeed, TheApartmentWithTwoHundredObjectsCanBeScrubbed) {
  if (!std::filesystem::exists(kApartment / "apartment.urdf")) GTEST_SKIP() << "no apartment";
  const auto folder = std::filesystem::temp_directory_path() / ("loci_gui_speed_" + std::to_string(getpid()));
  make_folder(folder);
  test::write_large_memory(folder / "large.loci", kApartment, "apartment.urdf", 200, 120);
  auto* application = dynamic_cast<TimedApplication*>(QCoreApplication::instance());
  ASSERT_NE(application, nullptr);
  MainWindow window(
      [](const std::string& path, Progress& progress) { return OpenMemory::open(path, progress); },
      {MapBackend::memory, false});
  window.resize(1280, 800);
  const WindowFigures figures = benchmark_window(*application, window, (folder / "large.loci").string(), 5);
  std::fputs(to_text(figures).c_str(), stdout);
  EXPECT_GT(figures.frames, 0U);
  EXPECT_GT(window.map().scene().objects().size(), 150U);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace loci::gui
