#include "gui/views/identity_view.h"

#include <QLabel>
#include <QScrollArea>
#include <QVBoxLayout>

#include "gui/text.h"
#include "gui/views/association_lines.h"
#include "gui/views/decision_matrix.h"

namespace loci::gui {
namespace {
constexpr size_t kScenes = 5;
}

IdentityView::IdentityView(Browser& browser, QWidget* parent)
    : Page(parent),
      browser_(browser),
      state_(new QLabel(this)),
      lines_(new AssociationLines),
      matrix_(new DecisionMatrix) {
  state_->setWordWrap(true);
  auto* inside = new QWidget;
  auto* column = new QVBoxLayout(inside);
  column->setContentsMargins(0, 0, 6, 0);
  column->addWidget(lines_);
  column->addWidget(matrix_);
  column->addStretch();
  auto* area = new QScrollArea(this);
  area->setWidget(inside);
  area->setWidgetResizable(true);
  area->setFrameShape(QFrame::NoFrame);
  area->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(8, 6, 2, 6);
  layout->addWidget(state_);
  layout->addWidget(area, 1);
  const auto choose = [this](qlonglong object) { browser_.selection().select_object(object); };
  connect(lines_, &AssociationLines::object_clicked, this, choose);
  connect(matrix_, &DecisionMatrix::object_clicked, this, choose);
  connect(lines_, &AssociationLines::scene_clicked, this,
          [this](qlonglong time) { browser_.selection().set_time(time); });
  connect(&browser_, &Browser::opened, this, &IdentityView::refresh);
  connect(&browser_, &Browser::belief_changed, this, &IdentityView::refresh);
  connect(&browser_, &Browser::selected, this, [this] { lines_->select(browser_.selection().object()); });
  refresh();
}

void IdentityView::refresh() {
  if (!is_looked_at()) return;
  const SceneEntry* scene = browser_.scene();
  if (scene == nullptr) {
    std::vector<SceneDecisions> none;
    show_decisions(none);
    return state_->setText("Open a memory to see why things were taken for what they are.");
  }
  browser_.reader().read<std::vector<SceneDecisions>>(
      this, "decisions", Urgency::selection,
      [id = scene->id](const BrowserData& memory) { return memory.decisions(id, kScenes); },
      [this](std::vector<SceneDecisions>& scenes) { show_decisions(scenes); });
}

void IdentityView::show_decisions(std::vector<SceneDecisions>& scenes) {
  const int zone = browser_.data() == nullptr ? 0 : browser_.data()->info().zone_minutes;
  const SceneDecisions last = scenes.empty() ? SceneDecisions{} : scenes.back();
  const size_t seen = last.observations.size();
  QString text = QString("Scene of %1: %2 thing%3 seen")
                     .arg(time_text(last.scene.time, zone).mid(11, 10))
                     .arg(seen)
                     .arg(seen == 1 ? "" : "s");
  if (seen == 0)
    text += "; a scene that sees things shows how they were recognised.";
  else if (!last.kept)
    text += "; its reasoning was not kept (loci-memory reason makes it anew).";
  state_->setText(text);
  matrix_->set(last);
  lines_->set(std::move(scenes), zone);
  lines_->select(browser_.selection().object());
}

}  // namespace loci::gui
