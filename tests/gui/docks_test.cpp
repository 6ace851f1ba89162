// Statistics and log: what they count and say, and what they save.

#include <QClipboard>
#include <QGuiApplication>
#include <QImage>
#include <QTableView>

#include "gui/core/background.h"
#include "gui/models/table_models.h"
#include "gui/views/log_view.h"
#include "gui/views/statistics_view.h"
#include "mapping/base/error.h"
#include "mapping/base/text/csv.h"
#include "mapping/base/text/json.h"
#include "tests/gui/window_fixture.h"

namespace loci::gui {
namespace {

class DocksInWindow : public test::BrowserWindow {
 protected:
  void show(const char* dock) {
    window.docks().show(dock);
    QApplication::processEvents();
    settle();
  }
  double value_of(const char* chart, const char* name) {
    for (const BarChart* drawn : window.docks().statistics().charts())
      if (drawn->chart().title.starts_with(chart))
        for (const auto& [bar, value] : drawn->chart().bars)
          if (bar == name) return value;
    return -1;
  }
};

TEST_F(DocksInWindow, StatisticsCountWhatTheMemoryHolds) {
  show("statistics");
  EXPECT_EQ(value_of("Observations", "observation"), 4);
  EXPECT_EQ(value_of("Objects by hour", "07"), 2);
  EXPECT_EQ(value_of("Objects by hour", "08"), 1);
  EXPECT_EQ(value_of("Objects by place", "counter_1"), 3);
  EXPECT_EQ(value_of("Objects by place", "table_1"), 1);
  EXPECT_EQ(value_of("Probabilities of associations", "90–100 %"), 4);
}

TEST_F(DocksInWindow, StatisticsAreSavedAsTableAndImage) {
  show("statistics");
  const auto csv = folder_.path / "s.csv", png = folder_.path / "s.png";
  window.docks().statistics().save_csv(QString::fromStdString(csv.string()));
  const CsvTable table = CsvTable::read(csv);
  EXPECT_EQ(table.header(), (std::vector<std::string>{"chart", "name", "value"}));
  EXPECT_EQ(table.number(0, 2), 4);
  window.docks().statistics().save_png(QString::fromStdString(png.string()));
  EXPECT_GT(QImage(QString::fromStdString(png.string())).height(), 300);
  EXPECT_THROW(window.docks().statistics().save_csv("/no/such/folder/s.csv"), Error);
}

TEST_F(DocksInWindow, TheLogListsRunsWithTheirScenesAndAClickGoesThere) {
  show("log");
  LogModel& model = window.docks().log().model();
  ASSERT_EQ(model.rowCount(), 4) << "one run, three scenes";
  EXPECT_TRUE(model.index(0, LogModel::text_column).data().toString().startsWith("3 scenes, took"));
  QTableView* table = window.docks().log().table();
  const QModelIndex second = model.index(2, LogModel::what_column);
  click(table->viewport(), table->visualRect(second).center());
  EXPECT_EQ(selection().time(), sample_.second);
}

TEST_F(DocksInWindow, TheLogFollowsTheSceneAndTellsWhatAnnotatorsDidInIt) {
  show("log");
  go_to(sample_.second);
  EXPECT_EQ(window.docks().log().model().entry(window.docks().log().table()->currentIndex().row()).scene,
            sample_.second);
  window.docks().log().copy_details();
  const QString copied = QGuiApplication::clipboard()->text();
  EXPECT_TRUE(copied.startsWith("annotators, 10.0 ms together")) << copied.toStdString();
  EXPECT_TRUE(copied.contains("NormalEstimator 2.5 ms")) << copied.toStdString();
  EXPECT_TRUE(copied.contains("warning: a drawer stands open")) << copied.toStdString();
}

TEST_F(DocksInWindow, ProblemsComeFirstAndTheirDetailsCanBeCopied) {
  show("log");
  Q_EMIT window.browser().failed("image of scene 2 is broken\nno PNG");
  QTableView* table = window.docks().log().table();
  table->setCurrentIndex(window.docks().log().model().index(0, 0));
  window.docks().log().copy_details();
  const QString copied = QGuiApplication::clipboard()->text();
  EXPECT_TRUE(copied.contains("no PNG")) << copied.toStdString();
  EXPECT_TRUE(copied.contains("sample.loci")) << copied.toStdString();
}

TEST_F(DocksInWindow, AnUnknownDockIsRefusedWithTheNamesOfAll) {
  try {
    window.docks().show("kitchen");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(error.hint().find("statistics"), std::string::npos);
  }
}

}  // namespace
}  // namespace loci::gui
