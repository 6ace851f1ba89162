#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <QApplication>
#include <QTest>
#include <QTreeView>
#include <filesystem>
#include <string>

#include "gui/core/background.h"
#include "gui/data/open_memory.h"
#include "gui/scene3d/object_actors.h"
#include "gui/views/object_card.h"
#include "gui/views/objects_tree.h"
#include "gui/window/main_window.h"
#include "mapping/base/files.h"
#include "tests/gui/sample_memory.h"

namespace loci::gui::test {

/// A window on the sample memory, shown on the virtual screen.
class BrowserWindow : public testing::Test {
 protected:
  /// A folder that goes when the test ends.
  struct Folder {
    Folder() { make_folder(path); }
    ~Folder() { std::filesystem::remove_all(path); }
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("loci_gui_test_" + std::to_string(getpid()));
  };

  explicit BrowserWindow(MapBackend backend = MapBackend::widget)
      : window([](const std::string& path, Progress& progress) { return OpenMemory::open(path, progress); },
               {backend, false}) {
    window.show_data(OpenMemory::open(sample_.path));
    window.show();
    EXPECT_TRUE(QTest::qWaitForWindowExposed(&window));
    QApplication::setActiveWindow(&window);  // No window manager does it here.
    QTest::qWait(50);
    settle();
  }

  /// Waits for what is read and shows it.
  static void settle() {
    finish_background();
    QApplication::processEvents();
    finish_background();
  }
  void go_to(TimeNs time) {
    selection().set_time(time);
    settle();
  }
  void choose(int64_t object) {
    selection().select_object(object);
    settle();
  }
  void press(Qt::Key key, Qt::KeyboardModifiers modifiers = Qt::NoModifier) {
    QTest::keyClick(&window, key, modifiers);
    settle();
  }
  static void click(QWidget* widget, const QPoint& at) {
    QTest::mouseClick(widget, Qt::LeftButton, Qt::NoModifier, at);
    settle();
  }
  /// The place where an object is believed to be.
  std::string place_of(int64_t object) {
    const Belief& belief = window.browser().belief();
    const BelievedObject* found = belief.find(object);
    return found == nullptr ? "unknown object" : belief.place_of(*found);
  }
  SelectionModel& selection() { return window.browser().selection(); }
  void click_in_tree(int64_t object) {
    const QModelIndex index = window.docks().tree().shown_index_of_object(object);
    ASSERT_TRUE(index.isValid());
    QTreeView* view = window.docks().tree().view();
    click(view->viewport(), view->visualRect(index).center());
  }
  const MapObject* drawn(int64_t object) {
    for (const MapObject& candidate : window.map().scene().objects())
      if (candidate.id == object) return &candidate;
    return nullptr;
  }

  Folder folder_;
  SampleMemory sample_ = write_sample_memory(folder_.path / "sample.loci");
  MainWindow window;
};

}  // namespace loci::gui::test
