#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <QApplication>
#include <QTest>
#include <QTreeView>
#include <filesystem>
#include <string>

#include "gui/data/memory_data.h"
#include "gui/main_window.h"
#include "gui/scene3d/object_actors.h"
#include "gui/views/object_card.h"
#include "gui/views/objects_tree.h"
#include "mapping/base/files.h"
#include "tests/gui/sample_memory.h"

namespace loci::test {

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

  BrowserWindow()
      : window([](const std::string& path, Progress& progress) { return open_memory_data(path, progress); },
               {MapBackend::widget, false}) {
    window.show_data(open_memory_data(sample_.path));
    window.show();
    EXPECT_TRUE(QTest::qWaitForWindowExposed(&window));
    QApplication::setActiveWindow(&window);  // No window manager does it here.
    QTest::qWait(50);
  }

  SelectionModel& selection() { return window.browser().selection(); }
  void click_in_tree(int64_t object) {
    const QModelIndex index = window.tree().shown_index_of_object(object);
    ASSERT_TRUE(index.isValid());
    QTreeView* view = window.tree().view();
    QTest::mouseClick(view->viewport(), Qt::LeftButton, Qt::NoModifier, view->visualRect(index).center());
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

}  // namespace loci::test
