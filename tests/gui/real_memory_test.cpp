// Every view of memories that were made from frames: nothing may fail, and each shows something.

#include <QCheckBox>
#include <QSignalSpy>
#include <QTableView>
#include <QTextBrowser>
#include <cstdlib>

#include "gui/views/compare_view.h"
#include "gui/views/log_view.h"
#include "gui/views/map/map_tools.h"
#include "gui/views/object_card.h"
#include "gui/views/question_bar.h"
#include "gui/views/scene_view.h"
#include "gui/views/statistics_view.h"
#include "gui/views/timeline/time_bar.h"
#include "gui/views/timeline/time_track.h"
#include "tests/gui/window_fixture.h"

namespace loci::gui {
namespace {

const std::filesystem::path kShared = LOCI_SHARED_DIR, kSource = LOCI_SOURCE_DIR, kPrograms = LOCI_BIN_DIR;

/// Frames, and how a memory is made from them.
struct Frames {
  const char* name;
  const char* folder;  ///< of shared data; "" = the sample day, which is simulated
  const char* options;
};

class RealMemory : public test::BrowserWindow, public testing::WithParamInterface<Frames> {
 protected:
  static bool run(const std::string& program, const std::string& arguments) {
    const std::string command = (kPrograms / program).string() + " " + arguments + " > /dev/null 2>&1";
    return std::system(command.c_str()) == 0;
  }

  void SetUp() override {
    const Frames& frames = GetParam();
    const std::string kitchen = (kSource / "apps/samples/kitchen.urdf").string();
    std::string recording = (kShared / frames.folder).string();
    if (!std::filesystem::exists(kPrograms / "loci-perceive") || !std::filesystem::exists(recording))
      GTEST_SKIP() << "no frames, or loci-perceive is not built";
    std::string options = frames.options;
    if (std::string(frames.folder).empty()) {
      if (!std::filesystem::exists(kPrograms / "loci-simulate")) GTEST_SKIP() << "loci-simulate is not built";
      recording = (folder_.path / "day").string();
      ASSERT_TRUE(run("loci-simulate",
                      "record " + (kSource / "apps/samples/day.yaml").string() + " -o " + recording));
      options += " --map " + kitchen;
    }
    const auto path = folder_.path / "real.loci";
    ASSERT_TRUE(run("loci-perceive", "run " + recording + " -m " + path.string() + " " + options));
    window.show_data(OpenMemory::open(path));
    settle();
    ASSERT_FALSE(window.browser().belief().objects.empty());
  }
};

TEST_P(RealMemory, ShowsSomethingInEachViewAndFailsNowhere) {
  const QSignalSpy failures(&window.browser(), &Browser::failed);
  press(Qt::Key_Home);
  for (size_t i = 1; i < window.browser().data()->scenes().size(); ++i) {
    press(Qt::Key_Right);
    EXPECT_EQ(window.browser().belief().time, window.browser().data()->scenes()[i].time);
    EXPECT_NE(window.browser().moment().content, nullptr);
  }
  size_t there = 0;
  for (const BelievedObject& believed : window.browser().belief().objects)
    there += believed.map_from_object && believed.status != memory::ObjectStatus::gone;
  EXPECT_GT(there, 0U);
  EXPECT_EQ(window.map().scene().objects().size(), there);
  EXPECT_GT(window.map().scene().point_count(), 1000U);
  const int64_t object = window.browser().belief().objects.front().object;
  click_in_tree(object);
  EXPECT_EQ(selection().object(), object);
  EXPECT_FALSE(window.map().scene().trace().empty());
  const BelievedObject* believed = window.browser().selected_object();
  ASSERT_NE(believed, nullptr);
  EXPECT_EQ(window.map().scene().object_point_count() > 100, believed->status != memory::ObjectStatus::gone);
  EXPECT_GE(window.docks().card().history()->model()->rowCount(), 1);
  for (int page = 0; page < window.docks().card().pages()->count(); ++page) {
    window.docks().card().pages()->setCurrentIndex(page);
    settle();
  }
  EXPECT_FALSE(window.docks().card().pages()->why()->toPlainText().isEmpty());
  bool outlined = false;
  for (const ImageBox& box : window.browser().moment().content->boxes)
    outlined = outlined || !box.color_outline.empty();
  EXPECT_TRUE(outlined || window.browser().moment().content->boxes.empty());
  for (const char* dock : {"identity", "statistics", "log", "tools3d", "compare"}) {
    window.docks().show(dock);
    settle();
  }
  EXPECT_FALSE(window.docks().compare().shown().empty()) << "objects came or were moved";
  window.docks().compare().beside_box()->setChecked(true);
  settle();
  EXPECT_NO_THROW(window.maps().then()->image());
  EXPECT_GE(window.docks().statistics().charts().size(), 4U);
  EXPECT_GT(window.docks().log().table()->model()->rowCount(), 5);
  window.question_bar().open();
  window.question_bar().ask(QString("where is object_%1").arg(object));
  settle();
  EXPECT_TRUE(window.question_bar().answers()->toPlainText().contains(QString("object_%1").arg(object)));
  EXPECT_EQ(failures.count(), 0) << failures.value(0).value(0).toString().toStdString();
}

INSTANTIATE_TEST_SUITE_P(Of, RealMemory,
                         testing::Values(Frames{"OsdChanges", "data/osd_changes", ""},
                                         Frames{"Redkitchen", "data/redkitchen_rgbd", "--every 20"},
                                         Frames{"SampleDay", "", "--every 4"}),
                         [](const auto& frames) { return std::string(frames.param.name); });

}  // namespace
}  // namespace loci::gui
