// Every view of a memory that was made from real frames: nothing may fail, and each shows something.

#include <QSignalSpy>
#include <QTableView>
#include <QTextBrowser>
#include <cstdlib>

#include "gui/views/compare_view.h"
#include "gui/views/log_view.h"
#include "gui/views/question_bar.h"
#include "gui/views/scene_image.h"
#include "gui/views/statistics_view.h"
#include "gui/views/time_bar.h"
#include "gui/views/time_track.h"
#include "tests/gui/window_fixture.h"

namespace loci {
namespace {

const std::filesystem::path kFrames = std::filesystem::path(LOCI_SHARED_DIR) / "data/osd_changes";
const std::filesystem::path kPerceive = std::filesystem::path(LOCI_BIN_DIR) / "loci-perceive";

class RealMemory : public test::BrowserWindow {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kFrames) || !std::filesystem::exists(kPerceive))
      GTEST_SKIP() << "no frames, or loci-perceive is not built";
    const auto path = folder_.path / "osd.loci";
    const std::string command =
        kPerceive.string() + " run " + kFrames.string() + " -m " + path.string() + " > /dev/null 2>&1";
    ASSERT_EQ(std::system(command.c_str()), 0);
    window.show_data(open_memory_data(path));
    settle();
    ASSERT_FALSE(window.browser().belief().objects.empty());
  }
};

TEST_F(RealMemory, ShowsSomethingInEachViewAndFailsNowhere) {
  const QSignalSpy failures(&window.browser(), &Browser::failed);
  press(Qt::Key_Home);
  for (size_t i = 1; i < window.browser().data()->scenes().size(); ++i) {
    press(Qt::Key_Right);
    EXPECT_EQ(window.browser().belief().time, window.browser().data()->scenes()[i].time);
    EXPECT_NE(window.browser().moment().content, nullptr);
  }
  size_t there = 0;
  for (const BelievedObject& believed : window.browser().belief().objects)
    there += believed.map_from_object && believed.presence != Presence::gone;
  EXPECT_GT(there, 0U);
  EXPECT_EQ(window.map().scene().objects().size(), there);
  EXPECT_GT(window.map().scene().point_count(), 1000U);
  const int64_t object = window.browser().belief().objects.front().id;
  click_in_tree(object);
  EXPECT_EQ(selection().object(), object);
  EXPECT_GE(window.card().history()->model()->rowCount(), 1);
  for (const char* dock : {"identity", "compare", "statistics", "log"}) {
    window.show_dock(dock);
    settle();
  }
  EXPECT_FALSE(window.compare().shown().empty()) << "things were moved";
  EXPECT_GE(window.statistics().charts().size(), 4U);
  EXPECT_GT(window.log().table()->model()->rowCount(), 10);
  window.question_bar().open();
  window.question_bar().ask(QString("where is object_%1").arg(object));
  settle();
  EXPECT_TRUE(window.question_bar().answers()->toPlainText().contains(QString("object_%1").arg(object)));
  EXPECT_EQ(failures.count(), 0) << failures.value(0).value(0).toString().toStdString();
}

}  // namespace
}  // namespace loci
